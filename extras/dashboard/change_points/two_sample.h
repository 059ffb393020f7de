// Do two stretches of a series, one after the other, have the same mean?
#pragma once

#include <cstddef>
#include <span>

namespace touchstone::change_points {

struct TwoSample {
  double before = 0.0;  // means
  double after = 0.0;
  double p = 1.0;  // two-sided
};

// Student's t test with pooled variance, of values winsorized at four robust standard deviations (twenty values or
// more), so that an outlier does not hide a change. The variance of the means is multiplied by the autocorrelation time
// of the residuals, (1 + r) / (1 - r) for a lag-1 correlation r > 0 (Bayley and Hammersley 1946; r less half of what
// chance gives independent values), so that noise that lasts for some builds does not pass as a change. p is therefore
// never smaller than Student's. Differences within `floor` are no difference (p = 1); if the
// residuals are within `floor` and the means are not, p = 0.
TwoSample pooled_t_test(std::span<const double> before, std::span<const double> after, double floor);

// The p of the test above, or a tenth of the largest p when any `outliers` values of either side are left out,
// whichever is larger: a change that rests on so few values has a large p. Both sides must hold more than `outliers`
// values, else p = 1.
TwoSample pooled_t_test_without(std::span<const double> before, std::span<const double> after, std::size_t outliers,
                                double floor);

}  // namespace touchstone::change_points
