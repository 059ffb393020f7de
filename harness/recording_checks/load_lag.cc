#include "harness/recording_checks/load_lag.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/recording_checks/block_order.h"

namespace touchstone::recording_checks {
namespace {

constexpr double widest_search_s = 1.0;
constexpr std::size_t most_grid_points = 20000;

struct Grid {
  double step_s = 0.0;
  std::vector<double> load, depth;
};

// Even samples of both, at the recording's own rate.
Grid resample(std::span<const double> t_s, std::span<const double> load_N, std::span<const double> depth_m) {
  Grid grid;
  const double span_s = t_s.back() - t_s.front();
  const std::size_t n = std::min(most_grid_points, t_s.size());
  grid.step_s = span_s / static_cast<double>(n - 1);
  std::size_t k = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = t_s.front() + grid.step_s * static_cast<double>(i);
    while (k + 2 < t_s.size() && t_s[k + 1] < t) ++k;
    const double share = std::clamp((t - t_s[k]) / (t_s[k + 1] - t_s[k]), 0.0, 1.0);
    grid.load.push_back(load_N[k] + share * (load_N[k + 1] - load_N[k]));
    grid.depth.push_back(depth_m[k] + share * (depth_m[k + 1] - depth_m[k]));
  }
  return grid;
}

// Correlation of load[i + lag] and depth[i] over [from, to) of the depth, as far as both are there.
double correlation_at(const Grid& grid, std::ptrdiff_t lag, std::size_t from, std::size_t to) {
  const auto n = static_cast<std::ptrdiff_t>(grid.load.size());
  const std::ptrdiff_t first = std::max(static_cast<std::ptrdiff_t>(from), -lag);
  const std::ptrdiff_t last = std::min({static_cast<std::ptrdiff_t>(to), n, n - lag});
  if (last - first < 16) return 0.0;
  const auto count = static_cast<std::size_t>(last - first);
  return correlation(std::span(grid.load).subspan(static_cast<std::size_t>(first + lag), count),
                     std::span(grid.depth).subspan(static_cast<std::size_t>(first), count));
}

std::ptrdiff_t best_lag(const Grid& grid, std::ptrdiff_t reach, std::size_t from, std::size_t to) {
  std::ptrdiff_t best = 0;
  double highest = correlation_at(grid, 0, from, to);
  for (std::ptrdiff_t lag = -reach; lag <= reach; ++lag) {
    const double c = correlation_at(grid, lag, from, to);
    if (c > highest) highest = c, best = lag;
  }
  return best;
}

double left(double correlation) { return 1.0 - correlation * correlation; }

// What load = a + k depth + b rate leaves of the load's square, with b >= 0; the rate by central differences.
double left_by_damping(const Grid& grid) {
  std::vector<double> load, depth, rate;
  for (std::size_t i = 2; i + 2 < grid.load.size(); ++i) {
    load.push_back(grid.load[i]);
    depth.push_back(grid.depth[i]);
    rate.push_back(grid.depth[i + 2] - grid.depth[i - 2]);
  }
  const double ld = correlation(load, depth), lr = correlation(load, rate), dr = correlation(depth, rate);
  const double determinant = 1.0 - dr * dr;
  if (!(determinant > 1e-9)) return left(ld);
  const double b = (lr - ld * dr) / determinant;
  if (!(b > 0.0)) return left(ld);
  const double k = (ld - lr * dr) / determinant;
  return 1.0 - (k * ld + b * lr);
}

}  // namespace

std::optional<LoadLag> find_load_lag(std::span<const double> t_s, std::span<const double> load_N,
                                     std::span<const double> depth_m, double most_left) {
  if (t_s.size() < 64) return std::nullopt;
  const Grid grid = resample(t_s, load_N, depth_m);
  const std::size_t n = grid.load.size();
  const auto reach = static_cast<std::ptrdiff_t>(
      std::min(widest_search_s, 0.125 * grid.step_s * static_cast<double>(n)) / grid.step_s);
  const std::ptrdiff_t lag = best_lag(grid, reach, 0, n);
  if (std::abs(lag) <= 2 || std::abs(lag) == reach) return std::nullopt;
  const double as_recorded = correlation_at(grid, 0, 0, n), shifted = correlation_at(grid, lag, 0, n);
  if (!(shifted > 0.0) || !(left(shifted) < most_left * left(as_recorded))) return std::nullopt;
  if (lag < 0 && !(left(shifted) < most_left * left_by_damping(grid))) return std::nullopt;
  const std::ptrdiff_t first = best_lag(grid, reach, 0, n / 2), second = best_lag(grid, reach, n / 2, n);
  for (const auto& [from, to] : {std::pair<std::size_t, std::size_t>{0, n / 2}, {n / 2, n}}) {
    const bool holds = left(correlation_at(grid, lag, from, to)) < left(correlation_at(grid, 0, from, to));
    if (!holds) return std::nullopt;
  }
  LoadLag result{grid.step_s * static_cast<double>(lag), as_recorded, shifted, 0.0};
  if (std::abs(second - first) > 2) result.drift_s = grid.step_s * static_cast<double>(second - first);
  return result;
}

}  // namespace touchstone::recording_checks
