// Quantiles and robust spread of a sample. The sample must not hold a NaN; an empty sample has NaN for each of them.
//
// There are several definitions of a quantile (Hyndman and Fan, Sample Quantiles in Statistical Packages, American
// Statistician 50, 1996), which differ by less than the distance between two neighbouring values. `quantile` and
// `median` are what statistics packages give by default; the others give a value that was observed, at the cost of one
// partial sort, and serve where the sample is large or the value stands for one of the samples.
#pragma once

#include <vector>

namespace touchstone::stats {

// Linear interpolation between order statistics (Hyndman and Fan's type 7). `q` in [0, 1].
double quantile(std::vector<double> sample, double q);
// The middle value; of an even number the mean of the two middle ones, rounded once (std::midpoint).
double median(std::vector<double> sample);

// The value with the rank n / 2, counted from 0: the median of an odd number, the larger of the two middle values of an
// even one.
double upper_median(std::vector<double> sample);
// The value with the rank q (n - 1), rounded down: at most a share `q` of the other values lies below it.
double lower_quantile(std::vector<double> sample, double q);
// The least value that a share `q` of the sample does not exceed (type 1: the inverse of the empirical distribution).
double reaching_quantile(std::vector<double> sample, double q);

// A normal distribution's standard deviation is this times the median of its absolute values: 1 / its 75 % quantile.
inline constexpr double normal_sigma_per_median = 1.482602218505602;
// Median absolute deviation from the median, scaled to the standard deviation of a normal distribution.
double median_absolute_deviation(const std::vector<double>& sample);

}  // namespace touchstone::stats
