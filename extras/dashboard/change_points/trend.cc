#include "change_points/trend.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/stats/quantile.h"

namespace touchstone::change_points {
namespace {

// Variance of Kendall's score S of n values in random order: n (n - 1) (2 n + 5) / 18, less the same of each group of
// equal values (Kendall 1975, chapter 4).
double kendall_variance(std::span<const double> values) {
  const auto term = [](double n) { return n * (n - 1.0) * (2.0 * n + 5.0) / 18.0; };
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  double variance = term(static_cast<double>(sorted.size()));
  for (auto at = sorted.begin(); at != sorted.end();) {
    const auto next = std::find_if(at, sorted.end(), [&](double v) { return v != *at; });
    variance -= term(static_cast<double>(next - at));
    at = next;
  }
  return variance;
}

// How many neighbours in a row say the same: for a process of first order with correlation r, (1 + r) / (1 - r), which
// is what the variance of a sum over them grows by. r is taken from the residuals at a distance of one.
double autocorrelation_time(std::span<const double> values, const Trend& trend) {
  double squares = 0.0;
  double products = 0.0;
  double last = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double residual = values[i] - trend.intercept - trend.slope * static_cast<double>(i);
    squares += residual * residual;
    if (i > 0) products += residual * last;
    last = residual;
  }
  if (squares == 0.0) return 1.0;
  const double correlation = std::clamp(products / squares, 0.0, 0.9);
  return (1.0 + correlation) / (1.0 - correlation);
}

}  // namespace

Trend find_trend(std::span<const double> values) {
  Trend trend;
  if (values.size() < 3) return trend;
  std::vector<double> slopes;
  slopes.reserve(values.size() * (values.size() - 1) / 2);
  // S: pairs that rise less pairs that fall (Mann 1945). The median of the slopes of all pairs is Theil's (1950) line,
  // which no share of outliers below 29 % moves far.
  double score = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = i + 1; j < values.size(); ++j) {
      const double difference = values[j] - values[i];
      score += difference > 0.0 ? 1.0 : difference < 0.0 ? -1.0 : 0.0;
      slopes.push_back(difference / static_cast<double>(j - i));
    }
  }
  trend.slope = stats::median(std::move(slopes));
  std::vector<double> residuals;
  residuals.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) residuals.push_back(values[i] - trend.slope * static_cast<double>(i));
  trend.intercept = stats::median(std::move(residuals));
  const double variance = kendall_variance(values) * autocorrelation_time(values, trend);
  if (variance > 0.0) {
    const double z = std::max(0.0, std::abs(score) - 1.0) / std::sqrt(variance);  // one for continuity
    // S is close to normal from ten values on: P(|Z| > z) = erfc(z / sqrt 2).
    trend.p = std::erfc(z / std::sqrt(2.0));
  }
  return trend;
}

double squares_about_line(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0;
  double moment = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i];
    // Places from their middle, (n - 1) / 2, so that mean and slope are found apart.
    moment += (static_cast<double>(i) - 0.5 * (n - 1.0)) * values[i];
  }
  // The squares of 0 ... n - 1 about their mean add up to n (n^2 - 1) / 12.
  const double slope = n > 1.0 ? moment / (n * (n * n - 1.0) / 12.0) : 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double residual = values[i] - sum / n - slope * (static_cast<double>(i) - 0.5 * (n - 1.0));
    squares += residual * residual;
  }
  return squares;
}

}  // namespace touchstone::change_points
