// Quantiles and robust spread of a sample.
#pragma once

#include <vector>

#include "harness/base/rooms.h"

namespace touchstone::stats {

// Linear interpolation between order statistics (Hyndman and Fan 1996, type 7). `q` in [0, 1]; the sample must not be
// empty and must not hold a NaN.
double quantile(std::vector<double> sample, double q);
double median(std::vector<double> sample);
// Median absolute deviation from the median, scaled to the standard deviation of a normal distribution.
double median_absolute_deviation(const std::vector<double>& sample);

}  // namespace touchstone::stats
