// Does a series rise or fall steadily? A test of trend that assumes no distribution.
#pragma once

#include <span>

namespace touchstone::change_points {

struct Trend {
  double slope = 0.0;      // per value: Theil and Sen's median of the slopes of all pairs
  double intercept = 0.0;  // of the line at the first value: median of the residuals
  double p = 1.0;          // two-sided, Mann and Kendall's test with correction for ties
};

// Mann (1945) and Kendall (1975): distribution-free. The variance is multiplied by the autocorrelation time of what the
// line leaves, as in two_sample.h. Fewer than three values: p = 1.
Trend find_trend(std::span<const double> values);

// Least squares line through the values at 0, 1, 2, ...: the sum of the squares of its residuals.
double squares_about_line(std::span<const double> values);

}  // namespace touchstone::change_points
