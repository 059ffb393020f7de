#include "harness/perception/judge/free_air.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "harness/base/least_squares.h"
#include "harness/perception/judge/growth.h"
#include "harness/perception/judge/replay_path.h"
#include "harness/perception/judge/slow_channels.h"
#include "harness/stats/quantile.h"

namespace touchstone::perception {
namespace {

constexpr double window_s = 0.05;
constexpr double pull_s = 0.02;
constexpr double release_s = 0.1;
constexpr double margin_s = 0.024;  // longer than the smoothing of positions
constexpr std::size_t fewest_windows = 4;
constexpr std::size_t fewest_releases = 2;

std::size_t samples_of(double duration_s, const FeltSeries& felt) {
  return static_cast<std::size_t>(std::max(1.0, std::round(duration_s * felt.rate_Hz)));
}

struct MeanOf {
  double value = 0.0;
  double error = 0.0;
};

MeanOf mean_of(const std::vector<double>& x) {
  const auto n = static_cast<double>(x.size());
  MeanOf result;
  if (x.empty()) return result;
  for (const double value : x) result.value += value / n;
  double squares = 0.0;
  for (const double value : x) squares += (value - result.value) * (value - result.value);
  result.error = n > 1.0 ? std::sqrt(squares / (n * (n - 1.0))) : std::abs(result.value);
  return result;
}

// The squared mean force of the window less what its own noise adds, if that is white.
double squared_force_N2(const FeltSeries& felt, std::size_t first, std::size_t length) {
  const auto n = static_cast<double>(length);
  double result = 0.0;
  for (const auto& axis : felt.force_N) {
    double mean = 0.0;
    for (std::size_t i = first; i < first + length; ++i) mean += axis[i] / n;
    double squares = 0.0;
    for (std::size_t i = first; i < first + length; ++i) squares += (axis[i] - mean) * (axis[i] - mean);
    result += mean * mean - squares / (n * (n - 1.0));
  }
  return result;
}

// Normal equations of the tool's five unknowns: drag, mass, and the steady force along each axis.
struct ToolSums {
  using Vector = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  Vector right = Vector::Zero();
  double squares_N2 = 0.0;

  void add(std::size_t axis, double velocity, double acceleration, double force_N) {
    Vector q = Vector::Zero();
    q(0) = -velocity;
    q(1) = -acceleration;
    q(static_cast<Eigen::Index>(2 + axis)) = 1.0;
    information += q * q.transpose();
    right += force_N * q;
    squares_N2 += force_N * force_N;
  }
  void add(const ToolSums& other, double sign) {
    information += sign * other.information;
    right += sign * other.right;
    squares_N2 += sign * other.squares_N2;
  }
  [[nodiscard]] Vector solved() const {
    Eigen::MatrixXd a = information;
    for (Eigen::Index i = 0; i < 5; ++i) a(i, i) += 1e-9 * a(i, i) + 1e-300;
    return solve_symmetric(a, right);
  }
};

// Velocity of each sample along the three axes.
std::array<double, 3> velocity_at(const FeltSeries& felt, std::size_t i) {
  const double speed = std::hypot(felt.slide_m_per_s[i], rest_m_per_s);
  return {-felt.rate_of_depth_m_per_s[i], speed * felt.slide_x[i], speed * felt.slide_y[i]};
}

// Over the samples that the depth is smoothed by.
std::array<double, 3> acceleration_at(const FeltSeries& felt, std::size_t i) {
  const std::size_t half = felt.smoothed_samples / 2;
  const std::size_t first = i < half ? 0 : i - half;
  const std::size_t last = std::min(felt.size() - 1, i + half);
  const auto before = velocity_at(felt, first);
  auto result = velocity_at(felt, last);
  for (std::size_t a = 0; a < 3; ++a)
    result[a] = (result[a] - before[a]) * felt.rate_Hz / static_cast<double>(last - first);
  return result;
}

}  // namespace

ToolInAir take_out_tool(FeltSeries& felt, const FirstContact& contact) {
  constexpr double explains = 0.5;
  constexpr double fewest_seconds = 0.2;
  ToolInAir tool;
  const double far_m = contact.depth_m - depth_grid(felt, contact).spacing_m;
  std::vector<ToolSums> blocks(jackknife_blocks);
  double samples = 0.0;
  double speeds = 0.0;
  double accelerations = 0.0;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    if (!(felt.depth_m[i] < far_m)) continue;
    const auto velocity = velocity_at(felt, i);
    const auto acceleration = acceleration_at(felt, i);
    samples += 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      blocks[i * jackknife_blocks / felt.size()].add(a, velocity[a], acceleration[a], felt.force_N[a][i]);
      speeds += velocity[a] * velocity[a];
      accelerations += acceleration[a] * acceleration[a];
    }
  }
  if (!contact.begins_free || samples < fewest_seconds * felt.rate_Hz) return tool;
  ToolSums total;
  for (const ToolSums& block : blocks) total.add(block, 1.0);
  const auto found = total.solved();
  tool.drag_N_s_per_m = found(0);
  tool.mass_kg = found(1);
  tool.speed_m_per_s = std::sqrt(speeds / samples);
  tool.acceleration_m_per_s2 = std::sqrt(accelerations / samples);
  // Jackknife: (n - 1) / n of the squares about the whole.
  constexpr double n = static_cast<double>(jackknife_blocks);
  for (const ToolSums& block : blocks) {
    ToolSums rest = total;
    rest.add(block, -1.0);
    const auto without = rest.solved();
    tool.drag_error = std::hypot(tool.drag_error, (without(0) - found(0)) * std::sqrt((n - 1.0) / n));
    tool.mass_error = std::hypot(tool.mass_error, (without(1) - found(1)) * std::sqrt((n - 1.0) / n));
  }
  // What varies: without the mean of each axis, and without white noise.
  double steady_N2 = 0.0;
  double noise_N2 = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    steady_N2 += std::pow(total.right(static_cast<Eigen::Index>(2 + a)), 2) / samples;
    noise_N2 += samples * std::pow(white_noise_of(felt.force_N[a]), 2);
  }
  const double explained_N2 = found.dot(total.right) - steady_N2;
  const double drag_N = tool.drag_N_s_per_m * tool.speed_m_per_s;
  const double inertia_N = tool.mass_kg * tool.acceleration_m_per_s2;
  const bool felt_at_all = std::hypot(drag_N, inertia_N) > 0.1 * fingertip_force.absolute_threshold;
  tool.seen = felt_at_all && explained_N2 > explains * (total.squares_N2 - steady_N2 - noise_N2);
  if (!tool.seen) return tool;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const auto velocity = velocity_at(felt, i);
    const auto acceleration = acceleration_at(felt, i);
    for (std::size_t a = 0; a < 3; ++a)
      felt.force_N[a][i] += tool.drag_N_s_per_m * velocity[a] + tool.mass_kg * acceleration[a];
  }
  return tool;
}

FreeAir free_air(const FeltSeries& felt, const Response& response) {
  const std::size_t n = felt.size();
  const std::size_t release = samples_of(release_s, felt);
  const std::size_t margin = samples_of(margin_s, felt);
  const std::size_t pull = samples_of(pull_s, felt);
  const std::size_t window = std::max<std::size_t>(4, samples_of(window_s, felt));
  const auto touches = [&](std::size_t i) { return felt.depth_m[i] >= response.contact_m; };
  // Where contact begins is known to a part of the depth: close to it is neither.
  const auto far = [&](std::size_t i) { return felt.depth_m[i] < response.contact_m - response.grid.spacing_m; };
  std::vector<double> pulls_N;
  std::vector<double> leaving_m_per_s;
  std::vector<double> squares_N2;
  std::size_t i = 0;
  while (i < n) {
    if (touches(i)) {
      ++i;
      continue;
    }
    const std::size_t first = i;
    while (i < n && !touches(i)) ++i;
    std::size_t from = first;
    if (first > 0) {
      const std::size_t last = std::min(i, first + release);
      double most_N = 0.0;
      for (std::size_t at = first; at + pull <= last; ++at) {
        double sum_N = 0.0;
        for (std::size_t k = at; k < at + pull; ++k) sum_N -= felt.force_N[0][k];
        most_N = std::max(most_N, sum_N / static_cast<double>(pull));
      }
      pulls_N.push_back(most_N);
      leaving_m_per_s.push_back(std::abs(felt.rate_of_depth_m_per_s[first]));
      from = last;
    }
    const std::size_t until = i < n ? i - std::min(i, margin) : n;
    for (std::size_t at = from; at + window <= until;) {
      if (!far(at) || !far(at + window - 1)) {
        ++at;
        continue;
      }
      squares_N2.push_back(squared_force_N2(felt, at, window));
      at += window;
    }
  }
  FreeAir result;
  const MeanOf square = mean_of(squares_N2);
  result.windows = squares_N2.size();
  result.force_N = std::sqrt(std::max(0.0, square.value));
  // Of a root: half the relative error of the square, and where the square is all error its root.
  const double spread_N2 = square.error * std::sqrt(static_cast<double>(squares_N2.size()));
  result.force_spread_N =
      result.force_N * result.force_N > spread_N2 ? 0.5 * spread_N2 / result.force_N : std::sqrt(spread_N2);
  const MeanOf pulled = mean_of(pulls_N);
  result.releases = pulls_N.size();
  result.pull_N = pulled.value;
  result.pull_error_N = pulled.error;
  if (!leaving_m_per_s.empty()) result.leaving_m_per_s = stats::median(leaving_m_per_s);
  return result;
}

AirDifference air_difference(const FreeAir& real, const FreeAir& rendered, bool same_motion,
                             const Thresholds& thresholds) {
  const NoticeableSteps steps(thresholds.force);
  const auto error_of = [&](double value_N, double error_N) { return steps(value_N + error_N) - steps(value_N); };
  AirDifference best;
  const auto keep = [&best](const AirDifference& other) {
    if (!best.known || other.jnd - other.standard_error > best.jnd - best.standard_error) best = other;
  };
  const auto compared = [&](AirCue cue, double real_N, double real_error_N, double rendered_N,
                            double rendered_error_N) {
    AirDifference result{true, cue, std::abs(steps(rendered_N) - steps(real_N)), 0.0, real_N, rendered_N};
    const double both_N = same_motion ? 0.0 : std::min(real_N, rendered_N);
    result.standard_error =
        std::hypot(error_of(real_N, real_error_N), error_of(rendered_N, rendered_error_N), error_of(both_N, both_N));
    return result;
  };
  if (std::min(real.windows, rendered.windows) >= fewest_windows)
    keep(compared(AirCue::steady, real.force_N, real.force_spread_N, rendered.force_N, rendered.force_spread_N));
  if (std::min(real.releases, rendered.releases) >= fewest_releases) {
    auto pull = compared(AirCue::release, real.pull_N, real.pull_error_N, rendered.pull_N, rendered.pull_error_N);
    if (!same_motion) {
      constexpr double bound = 0.5;  // a bound is two standard errors
      const GrowthBounds growth = growth_bounds(real.leaving_m_per_s / rendered.leaving_m_per_s, 0.0);
      const double bound_N = rendered.pull_N * (real.pull_N > rendered.pull_N ? growth.most : growth.least);
      pull.standard_error = std::hypot(pull.standard_error, bound * std::abs(steps(bound_N) - steps(rendered.pull_N)));
    }
    keep(pull);
  }
  const ToolInAir& own = real.tool;
  const ToolInAir& other = rendered.tool;
  if ((own.seen || other.seen) && std::min(own.speed_m_per_s, other.speed_m_per_s) > 0.0) {
    const auto moved = [&](AirCue cue, double real_value, double rendered_value, double real_error,
                           double rendered_error, double motion) {
      const double real_N = std::max(0.0, motion * real_value);
      const double rendered_N = std::max(0.0, motion * rendered_value);
      const auto jnd_of = [&](double force_N) {
        return force_at_depth_jnd(steps(force_N) - steps(real_N), real_N, force_N, 1.0, thresholds);
      };
      keep({true, cue, jnd_of(rendered_N),
            std::hypot(error_of(real_N, motion * real_error), error_of(rendered_N, motion * rendered_error)),
            real_value, rendered_value});
    };
    moved(AirCue::drag, own.drag_N_s_per_m, other.drag_N_s_per_m, own.drag_error, other.drag_error,
          std::min(own.speed_m_per_s, other.speed_m_per_s));
    moved(AirCue::mass, own.mass_kg, other.mass_kg, own.mass_error, other.mass_error,
          std::min(own.acceleration_m_per_s2, other.acceleration_m_per_s2));
  }
  return best;
}

}  // namespace touchstone::perception
