// The distributions that the perceptual evaluation needs, by Boost.Math, and robust summaries of a series.
#pragma once

#include <span>
#include <vector>

#include "harness/base/rooms.h"

namespace touchstone::perception {

// Standard normal distribution function and its inverse (0 < p < 1).
double normal_cdf(double z);
double normal_quantile(double p);
// P(X >= x) for chi-squared with `degrees` > 0 degrees of freedom.
double chi_squared_tail(double x, double degrees);
// Two-sided 97.5 % point of Student's t with `degrees` > 0 degrees of freedom.
double student_t_975(double degrees);

double mean(std::span<const double> x);
// Root of the mean square about the mean, divided by n (as eq 18 does).
double standard_deviation(std::span<const double> x);
double root_mean_square(std::span<const double> x);
// Median of the values; NaN for none.
double median(std::vector<double> x);
// Ranks 1..n, ties sharing their mean rank.
std::vector<double> ranks(std::span<const double> x);

}  // namespace touchstone::perception
