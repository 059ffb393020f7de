#include "change_points/two_sample.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"
#include "harness/stats/summary.h"

namespace touchstone::change_points {
namespace {

struct Residuals {
  double squares = 0.0;
  double products = 0.0;  // of neighbours
  double largest = 0.0;

  void add(std::span<const double> values, double mean) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double residual = values[i] - mean;
      squares += residual * residual;
      largest = std::max(largest, std::abs(residual));
      if (i > 0) products += residual * (values[i - 1] - mean);
    }
  }
};

// Both stretches with what lies farther than four robust standard deviations from its own median pulled in to there.
// Fewer than twenty values say too little about their spread: they stay.
std::pair<std::vector<double>, std::vector<double>> winsorized(std::span<const double> before,
                                                               std::span<const double> after) {
  constexpr std::size_t enough = 20;
  constexpr double deviations = 4.0;
  std::pair clipped(std::vector<double>(before.begin(), before.end()), std::vector<double>(after.begin(), after.end()));
  if (before.size() + after.size() < enough) return clipped;
  const double left = stats::median(clipped.first);
  const double right = stats::median(clipped.second);
  std::vector<double> residuals;
  residuals.reserve(before.size() + after.size());
  for (const double value : before) residuals.push_back(value - left);
  for (const double value : after) residuals.push_back(value - right);
  const double most = deviations * stats::median_absolute_deviation(residuals);
  if (most == 0.0) return clipped;
  for (double& value : clipped.first) value = std::clamp(value, left - most, left + most);
  for (double& value : clipped.second) value = std::clamp(value, right - most, right + most);
  return clipped;
}

// The `count` values that pull the mean away from `other` are left out; the order of the rest stays.
std::vector<double> without(std::span<const double> values, double other, std::size_t count) {
  const bool above = stats::mean(values) > other;
  std::vector<double> rest(values.begin(), values.end());
  for (std::size_t i = 0; i < count; ++i)
    rest.erase(above ? std::ranges::max_element(rest) : std::ranges::min_element(rest));
  return rest;
}

// Evidence goes with any values, also where they are none of the worst.
constexpr double weaker_without = 10.0;

}  // namespace

TwoSample pooled_t_test(std::span<const double> raw_before, std::span<const double> raw_after, double floor) {
  const auto [before, after] = winsorized(raw_before, raw_after);
  const auto n = static_cast<double>(before.size());
  const auto m = static_cast<double>(after.size());
  TwoSample test{stats::mean(before), stats::mean(after), 1.0};
  if (!(std::abs(test.after - test.before) > floor)) return test;
  Residuals residuals;
  residuals.add(before, test.before);
  residuals.add(after, test.after);
  if (residuals.largest <= floor) {
    test.p = 0.0;
    return test;
  }
  const double degrees = n + m - 2.0;
  if (degrees < 1.0) return test;
  // Of independent values it would be off zero by 1 / sqrt(n + m): half of that is no sign of any.
  const double chance = 0.5 / std::sqrt(n + m);
  const double correlation = std::clamp(residuals.products / residuals.squares - chance, 0.0, 0.9);
  const double inflation = (1.0 + correlation) / (1.0 - correlation);
  const double error = std::sqrt(residuals.squares / degrees * (1.0 / n + 1.0 / m) * inflation);
  test.p = stats::student_p((test.after - test.before) / error, degrees);
  return test;
}

TwoSample pooled_t_test_without(std::span<const double> before, std::span<const double> after, std::size_t outliers,
                                double floor) {
  TwoSample test = pooled_t_test(before, after, floor);
  if (before.size() <= outliers || after.size() <= outliers) {
    test.p = 1.0;
    return test;
  }
  if (outliers == 0) return test;
  const auto left = without(before, test.after, outliers);
  const auto right = without(after, test.before, outliers);
  const double p_without = std::max(pooled_t_test(left, after, floor).p, pooled_t_test(before, right, floor).p);
  test.p = std::max(test.p, p_without / weaker_without);
  return test;
}

}  // namespace touchstone::change_points
