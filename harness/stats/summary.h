// What a series of numbers is in one number, and its ranks.
#pragma once

#include <span>
#include <vector>

namespace touchstone::stats {

// These three give NaN for an empty series.
double mean(std::span<const double> x);
// Root of the mean square about the mean: divided by n, not by n - 1.
double standard_deviation(std::span<const double> x);
double root_mean_square(std::span<const double> x);

// Ranks 1..n, ties sharing their mean rank (as Spearman's correlation and the rank tests take them).
std::vector<double> ranks(std::span<const double> x);

}  // namespace touchstone::stats
