#include "harness/bisection/commit_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::bisection {

std::vector<std::size_t> CommitCurve::measured_positions() const {
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < commits_.size(); ++i) {
    if (measured(i)) positions.push_back(i);
  }
  return positions;
}

double CommitCurve::level(std::size_t position) const {
  std::vector<double> sorted = commits_.at(position).runs;
  std::ranges::sort(sorted);
  const std::size_t n = sorted.size();
  if (n == 0) return std::nan("");
  return n % 2 == 1 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}

double CommitCurve::noise() const {
  double squares = 0.0;
  for (std::size_t i = 0; i < commits_.size(); ++i) {
    if (!measured(i) || runs(i) < 2) continue;
    const double middle = level(i);
    for (const double value : commits_[i].runs) squares += (value - middle) * (value - middle);
  }
  const std::size_t freedom = degrees_of_freedom();
  return freedom == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(freedom));
}

std::size_t CommitCurve::degrees_of_freedom() const {
  std::size_t freedom = 0;
  for (std::size_t i = 0; i < commits_.size(); ++i) {
    if (measured(i)) freedom += runs(i) - 1;
  }
  return freedom;
}

double CommitCurve::variance_of_median(std::size_t n) {
  const auto count = static_cast<double>(n);
  // One value is itself, the median of two their mean; from three on the limit pi / 2 n, which lies above the truth.
  return n <= 2 ? 1.0 / std::max(1.0, count) : std::numbers::pi / (2.0 * count);
}

double CommitCurve::change_error(std::size_t from, std::size_t to) const {
  return noise() * std::sqrt(variance_of_median(runs(from)) + variance_of_median(runs(to)));
}

}  // namespace touchstone::bisection
