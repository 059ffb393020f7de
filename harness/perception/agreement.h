// How well an objective method ranks the conditions as people do: rank correlation with the subjective scale.
#pragma once

#include <span>

namespace touchstone::perception {

struct RankCorrelation {
  double coefficient = 0.0;  // NaN where one of the series is constant
  double low95 = -1.0;       // confidence interval; -1..1 where the conditions are too few for one
  double high95 = 1.0;
  double p_two_sided = 1.0;  // of no correlation: exact (all orders) up to 8 values, normal approximation beyond
};

// Spearman's rho; interval by Fisher's z with the standard error of Bonett and Wright (2000), sqrt((1 + rho^2/2) /
// (n-3)). Throws BadData for series of unequal length or fewer than 3 values.
RankCorrelation spearman(std::span<const double> x, std::span<const double> y);
// Kendall's tau-b; interval by Fisher's z with the standard error sqrt(0.437 / (n-4)) (Fieller, Hartley, Pearson 1957).
RankCorrelation kendall(std::span<const double> x, std::span<const double> y);

}  // namespace touchstone::perception
