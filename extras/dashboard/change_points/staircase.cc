#include "change_points/staircase.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/stats/quantile.h"

namespace touchstone::change_points {
namespace {

constexpr std::size_t fewest_steps = 2;  // one step alone is held against a line by its own criterion
constexpr std::size_t most_steps = 5;
constexpr std::size_t shortest_tread = 3;
constexpr std::size_t treads_in_stretch = 10;
// From simulated lines: see the header.
constexpr double needed = 4.0;
constexpr double needed_per_step = 5.0;

std::vector<double> pulled_in(std::span<const double> values, const Trend& trend) {
  constexpr double deviations = 4.0;
  std::vector<double> residuals(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    residuals[i] = values[i] - trend.intercept - trend.slope * static_cast<double>(i);
  const double most = deviations * stats::median_absolute_deviation(residuals);
  std::vector<double> out(values.begin(), values.end());
  if (most == 0.0) return out;
  // Offsets leave the comparison as it is; without the intercept the squares do not cancel.
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = trend.slope * static_cast<double>(i) + std::clamp(residuals[i], -most, most);
  return out;
}

// Squares about the mean of any stretch, from sums.
class Squares {
 public:
  explicit Squares(std::span<const double> values) : sums_(values.size() + 1, 0.0), squares_(values.size() + 1, 0.0) {
    double center = 0.0;
    for (const double value : values) center += value / static_cast<double>(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = values[i] - center;
      sums_[i + 1] = sums_[i] + value;
      squares_[i + 1] = squares_[i] + value * value;
    }
  }

  [[nodiscard]] double of(std::size_t first, std::size_t end) const {
    const double sum = sums_[end] - sums_[first];
    return squares_[end] - squares_[first] - sum * sum / static_cast<double>(end - first);
  }

 private:
  std::vector<double> sums_;
  std::vector<double> squares_;
};

// Of independent values the correlation would be off zero by 1 / sqrt(n): half of that is no sign of any
// (two_sample.h).
double autocorrelation_time(std::span<const double> values, const std::vector<std::size_t>& steps) {
  double squares = 0.0;
  double products = 0.0;
  std::size_t first = 0;
  for (std::size_t tread = 0; tread <= steps.size(); ++tread) {
    const std::size_t end = tread < steps.size() ? steps[tread] : values.size();
    double mean = 0.0;
    for (std::size_t i = first; i < end; ++i) mean += values[i] / static_cast<double>(end - first);
    for (std::size_t i = first; i < end; ++i) {
      squares += (values[i] - mean) * (values[i] - mean);
      if (i > first) products += (values[i] - mean) * (values[i - 1] - mean);
    }
    first = end;
  }
  if (squares == 0.0) return 1.0;
  const double chance = 0.5 / std::sqrt(static_cast<double>(values.size()));
  const double correlation = std::clamp(products / squares - chance, 0.0, 0.9);
  return (1.0 + correlation) / (1.0 - correlation);
}

}  // namespace

std::vector<std::size_t> find_staircase(std::span<const double> raw, const Trend& trend) {
  const std::size_t n = raw.size();
  const std::size_t tread = std::max(shortest_tread, n / treads_in_stretch);
  if (n < (fewest_steps + 1) * tread) return {};
  const std::vector<double> values = pulled_in(raw, trend);
  const Squares squares(values);
  const double line = squares_about_line(values);
  constexpr double none = std::numeric_limits<double>::infinity();
  // least[end] of the current number of steps, and where its last step stands, for every number of steps.
  std::vector<double> least(n + 1, none);
  for (std::size_t end = tread; end <= n; ++end) least[end] = squares.of(0, end);
  std::vector<std::vector<std::size_t>> last_step(1, std::vector<std::size_t>(n + 1, 0));
  std::vector<std::size_t> best;
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t steps = 1; steps <= most_steps && (steps + 1) * tread <= n; ++steps) {
    std::vector<double> next(n + 1, none);
    last_step.emplace_back(n + 1, 0);
    for (std::size_t end = (steps + 1) * tread; end <= n; ++end) {
      for (std::size_t at = steps * tread; at + tread <= end; ++at) {
        const double sum = least[at] + squares.of(at, end);
        if (sum < next[end]) next[end] = sum, last_step[steps][end] = at;
      }
    }
    least = std::move(next);
    if (steps < fewest_steps) continue;
    std::vector<std::size_t> places(steps);
    std::size_t end = n;
    for (std::size_t i = steps; i-- > 0;) places[i] = end = last_step[i + 1][end];
    const double ratio = static_cast<double>(n) * std::log(line / std::max(least[n], 1e-300));
    const double gain = ratio / autocorrelation_time(values, places);
    if (gain <= needed + needed_per_step * static_cast<double>(steps)) continue;
    double criterion = gain - 3.0 * std::log(static_cast<double>(n)) * static_cast<double>(steps);
    for (std::size_t i = 0; i <= steps; ++i) {
      const std::size_t first = i == 0 ? 0 : places[i - 1];
      const std::size_t tread_end = i == steps ? n : places[i];
      criterion -= std::log(static_cast<double>(tread_end - first) / static_cast<double>(n));
    }
    if (criterion > largest) largest = criterion, best = std::move(places);
  }
  return best;
}

}  // namespace touchstone::change_points
