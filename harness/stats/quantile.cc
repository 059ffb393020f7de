#include "harness/stats/quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace touchstone::stats {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

double at_rank(std::vector<double>& sample, std::size_t rank) {
  const auto at = sample.begin() + static_cast<std::ptrdiff_t>(rank);
  std::ranges::nth_element(sample, at);
  return *at;
}

}  // namespace

double quantile(std::vector<double> sample, double q) {
  if (sample.empty()) return none;
  const double place = q * static_cast<double>(sample.size() - 1);
  const auto low = static_cast<std::size_t>(std::floor(place));
  const double share = place - std::floor(place);
  const double below = at_rank(sample, low);
  if (share == 0.0) return below;
  const double above = *std::min_element(sample.begin() + static_cast<std::ptrdiff_t>(low) + 1, sample.end());
  return below + share * (above - below);
}

double median(std::vector<double> sample) {
  if (sample.empty()) return none;
  const std::size_t middle = sample.size() / 2;
  const double upper = at_rank(sample, middle);
  if (sample.size() % 2 == 1) return upper;
  return std::midpoint(*std::max_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(middle)), upper);
}

double upper_median(std::vector<double> sample) { return sample.empty() ? none : at_rank(sample, sample.size() / 2); }

double lower_quantile(std::vector<double> sample, double q) {
  if (sample.empty()) return none;
  return at_rank(sample, static_cast<std::size_t>(q * static_cast<double>(sample.size() - 1)));
}

double reaching_quantile(std::vector<double> sample, double q) {
  if (sample.empty()) return none;
  const double reached = std::max(1.0, std::ceil(q * static_cast<double>(sample.size())));
  return at_rank(sample, std::min(static_cast<std::size_t>(reached), sample.size()) - 1);
}

double median_absolute_deviation(const std::vector<double>& sample) {
  const double middle = median(sample);
  std::vector<double> deviations;
  deviations.reserve(sample.size());
  for (const double value : sample) deviations.push_back(std::abs(value - middle));
  return normal_sigma_per_median * median(std::move(deviations));
}

}  // namespace touchstone::stats
