#include "harness/stats/quantile.h"

#include <algorithm>
#include <cmath>

namespace touchstone::stats {

double quantile(std::vector<double> sample, double q) {
  const double place = q * static_cast<double>(sample.size() - 1);
  const auto low = static_cast<std::size_t>(std::floor(place));
  const double share = place - std::floor(place);
  const auto at = sample.begin() + static_cast<std::ptrdiff_t>(low);
  std::ranges::nth_element(sample, at);
  if (share == 0.0) return *at;
  const double above = *std::min_element(at + 1, sample.end());
  return *at + share * (above - *at);
}

double median(std::vector<double> sample) { return quantile(std::move(sample), 0.5); }

double median_absolute_deviation(const std::vector<double>& sample) {
  const double middle = median(sample);
  std::vector<double> deviations;
  deviations.reserve(sample.size());
  for (const double value : sample) deviations.push_back(std::abs(value - middle));
  constexpr double of_a_normal = 1.482602218505602;  // 1 / the 75 % quantile of the standard normal
  return of_a_normal * median(std::move(deviations));
}

}  // namespace touchstone::stats
