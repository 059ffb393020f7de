#include "harness/perception/judge/felt_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/perception/filters/weber_law.h"
#include "harness/perception/haptic_data_matrix.h"
#include "harness/perception/judge/replay_path.h"
#include "harness/stats/quantile.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

constexpr double smoothing_s = 0.02;
constexpr double longest_gap = 20.0;
constexpr std::size_t fewest_samples = 50;

// Mean over 2 m + 1 samples by a running sum, fewer at the ends, and the least-squares slope over the same samples.
struct Smoothed {
  std::vector<double> value;
  std::vector<double> slope_per_s;
};

Smoothed smoothed(const std::vector<double>& x, double rate_Hz, std::size_t m) {
  const std::size_t n = x.size();
  Smoothed result{std::vector<double>(n), std::vector<double>(n)};
  // Sums of x and of i x from the start; offset by the first value, so that little is lost in differences.
  std::vector<double> sum(n + 1, 0.0);
  std::vector<double> moment(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    sum[i + 1] = sum[i] + (x[i] - x[0]);
    moment[i + 1] = moment[i] + static_cast<double>(i) * (x[i] - x[0]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = i < m ? 0 : i - m;
    const std::size_t last = std::min(n - 1, i + m);
    const auto count = static_cast<double>(last - first + 1);
    const double total = sum[last + 1] - sum[first];
    const double middle = 0.5 * static_cast<double>(first + last);
    // Least squares over `count` even places about their middle m: slope = sum (i - m) x_i / sum (i - m)^2, and the
    // squares add up to count (count^2 - 1) / 12.
    const double slope = (moment[last + 1] - moment[first] - middle * total) * 12.0 / (count * (count * count - 1.0));
    // The straight line's value at i: the mean where the window is symmetric.
    result.value[i] = x[0] + total / count + slope * (static_cast<double>(i) - middle);
    result.slope_per_s[i] = slope * rate_Hz;
  }
  return result;
}

// Beyond these nothing was measured, and powers of forces and places would be no numbers.
constexpr double most_force_N = 1e9;
constexpr double farthest_m = 1e6;

void check_felt(const Recording& r) {
  if (r.f_W_N.size() != r.size()) {
    throw BadData(fmt::format("{}: has no force; a perceptual evaluation compares forces", r.source));
  }
  if (r.size() < fewest_samples) {
    throw BadData(fmt::format("{}: {} samples; at least {} are needed", r.source, r.size(), fewest_samples));
  }
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (!r.f_W_N[i].allFinite() || !r.motion.p_W_m[i].allFinite() || !std::isfinite(r.motion.t_s[i])) {
      throw BadData(fmt::format("{}: sample {} (t = {} s) is not a finite number; remove or repair the sample",
                                r.source, i + 1, r.motion.t_s[i]));
    }
    const double force_N = r.f_W_N[i].cwiseAbs().maxCoeff();
    const double place_m = r.motion.p_W_m[i].cwiseAbs().maxCoeff();
    if (force_N > most_force_N || place_m > farthest_m) {
      throw BadData(fmt::format(
          "{}: sample {} (t = {} s) has a force of {:.3g} N at a place of {:.3g} m; at most {:g} N and {:g} m were "
          "expected: remove or repair the sample, or name the unit in the header",
          r.source, i + 1, r.motion.t_s[i], force_N, place_m, most_force_N, farthest_m));
    }
    if (i > 0 && !(r.motion.t_s[i] > r.motion.t_s[i - 1])) {
      throw BadData(fmt::format("{}: time does not advance from sample {} to {} ({} s to {} s)", r.source, i, i + 1,
                                r.motion.t_s[i - 1], r.motion.t_s[i]));
    }
  }
}

// The columns of one axis at even times.
std::vector<double> at_even_times(const std::vector<double>& t_s, const std::vector<double>& x, double rate_Hz,
                                  std::size_t count) {
  std::vector<double> result(count);
  std::size_t i = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double t = t_s.front() + static_cast<double>(k) / rate_Hz;
    while (i + 2 < t_s.size() && t_s[i + 1] <= t) ++i;
    const double share = std::clamp((t - t_s[i]) / (t_s[i + 1] - t_s[i]), 0.0, 1.0);
    result[k] = x[i] + share * (x[i + 1] - x[i]);
  }
  return result;
}

}  // namespace

Vec3 pressing_direction(const Recording& recording) {
  check_felt(recording);
  const Vec3 mean = press_direction(recording);
  const std::size_t n = recording.size();
  const double rate_Hz = static_cast<double>(n - 1) / (recording.motion.t_s.back() - recording.motion.t_s.front());
  const auto half = static_cast<std::size_t>(std::max(1.0, std::round(0.5 * smoothing_s * rate_Hz)));
  std::vector<double> velocity[3];
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> column(n);
    for (std::size_t i = 0; i < n; ++i) column[i] = recording.motion.p_W_m[i][axis];
    velocity[axis] = smoothed(column, rate_Hz, half).slope_per_s;
  }
  // Coulomb: f is the load times n - mu u, u the direction of motion. Least squares over the samples in contact: mu
  // from how f goes with u about their means, n from the means; the load is along n, so that some rounds are needed.
  constexpr int rounds = 8;
  constexpr double to_and_fro = 0.1;  // share of the motion that must go another way
  Vec3 outward = mean;
  for (int round = 0; round < rounds; ++round) {
    double weight = 0.0;
    double direction_squares = 0.0;
    double along = 0.0;
    Vec3 direction_sum = Vec3::Zero();
    Vec3 force_sum = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3& f = recording.f_W_N[i];
      const double load_N = f.dot(outward);
      if (!(load_N > fingertip_force.absolute_threshold)) continue;
      const Vec3 v(velocity[0][i], velocity[1][i], velocity[2][i]);
      const Vec3 u = v / std::hypot(v.norm(), rest_m_per_s);
      weight += load_N;
      direction_squares += load_N * u.squaredNorm();
      along += f.dot(u);
      direction_sum += load_N * u;
      force_sum += f;
    }
    const double spread = weight > 0.0 ? direction_squares - direction_sum.squaredNorm() / weight : 0.0;
    if (!(spread > to_and_fro * weight)) return mean;
    const double friction = -(along - force_sum.dot(direction_sum) / weight) / spread;
    outward = (force_sum + friction * direction_sum).normalized();
  }
  return outward;
}

FeltSeries felt_series(const Recording& recording, const Vec3& outward) {
  check_felt(recording);
  const std::vector<double>& t_s = recording.motion.t_s;
  const std::size_t n = recording.size();
  FeltSeries felt;
  felt.name = recording.source;
  felt.start_s = t_s.front();
  std::vector<double> steps_s;
  steps_s.reserve(n - 1);
  for (std::size_t i = 1; i < n; ++i) steps_s.push_back(t_s[i] - t_s[i - 1]);
  const double typical_s = stats::median(steps_s);
  double worst = 0.0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (steps_s[i] > longest_gap * typical_s) {
      throw BadData(
          fmt::format("{}: a hole of {:.4g} s after t = {:.6g} s; cut the recording there: nothing is made "
                      "up over more than {:.0f} sampling intervals",
                      felt.name, steps_s[i], t_s[i], longest_gap));
    }
    worst = std::max(worst, std::abs(steps_s[i] - typical_s) / typical_s);
  }
  felt.rate_Hz = static_cast<double>(n - 1) / (t_s.back() - t_s.front());
  felt.same_clock = worst <= 0.05;

  const Vec3 axis0 = outward.normalized();
  // Along the frame's x where it can be, however little the direction is off an axis: places are told along it.
  const Vec3 towards = std::abs(axis0.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 axis1 = (towards - towards.dot(axis0) * axis0).normalized();
  const Vec3 axis2 = axis0.cross(axis1);
  felt.axis[0] = axis0;
  felt.axis[1] = axis1;
  felt.axis[2] = axis2;
  std::vector<double> place[3];
  for (auto& column : place) column.resize(n);
  for (auto& column : felt.force_N) column.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& p = recording.motion.p_W_m[i];
    const Vec3& f = recording.f_W_N[i];
    place[0][i] = -p.dot(axis0);
    place[1][i] = p.dot(axis1);
    place[2][i] = p.dot(axis2);
    felt.force_N[0][i] = f.dot(axis0);
    felt.force_N[1][i] = f.dot(axis1);
    felt.force_N[2][i] = f.dot(axis2);
  }
  if (!felt.same_clock) {
    for (auto& column : place) column = at_even_times(t_s, column, felt.rate_Hz, n);
    for (auto& column : felt.force_N) column = at_even_times(t_s, column, felt.rate_Hz, n);
  }
  const auto half = static_cast<std::size_t>(std::max(1.0, std::round(0.5 * smoothing_s * felt.rate_Hz)));
  felt.smoothed_samples = 2 * half + 1;
  felt.position_noise_m = white_noise_of(place[0]);
  auto depth = smoothed(place[0], felt.rate_Hz, half);
  felt.depth_m = std::move(depth.value);
  felt.rate_of_depth_m_per_s = std::move(depth.slope_per_s);
  auto along_1 = smoothed(place[1], felt.rate_Hz, half);
  auto along_2 = smoothed(place[2], felt.rate_Hz, half);
  felt.slide_x = std::move(along_1.slope_per_s);
  felt.slide_y = std::move(along_2.slope_per_s);
  felt.place_m[0] = std::move(along_1.value);
  felt.place_m[1] = std::move(along_2.value);
  // The direction of sliding, v / sqrt(v^2 + v_rest^2): at rest it goes to nought instead of jumping.
  for (std::size_t i = 0; i < n; ++i) {
    const double x = felt.slide_x[i];
    const double y = felt.slide_y[i];
    felt.slide_m_per_s.push_back(std::hypot(x, y));
    const double speed = std::hypot(felt.slide_m_per_s.back(), rest_m_per_s);
    felt.slide_x[i] = x / speed;
    felt.slide_y[i] = y / speed;
  }
  return felt;
}

FeltSeries with_lag(const FeltSeries& felt, double lag_s) {
  FeltSeries result = felt;
  const double samples = lag_s * felt.rate_Hz;
  const auto whole = static_cast<std::size_t>(samples);
  const double part = samples - static_cast<double>(whole);
  const auto shift = [&](const std::vector<double>& from, std::vector<double>& to) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      const double later = from[i < whole ? 0 : i - whole];
      const double earlier = from[i < whole + 1 ? 0 : i - whole - 1];
      to[i] = later + part * (earlier - later);
    }
  };
  shift(felt.depth_m, result.depth_m);
  shift(felt.rate_of_depth_m_per_s, result.rate_of_depth_m_per_s);
  shift(felt.slide_x, result.slide_x);
  shift(felt.slide_y, result.slide_y);
  shift(felt.slide_m_per_s, result.slide_m_per_s);
  for (std::size_t a = 0; a < 2; ++a) shift(felt.place_m[a], result.place_m[a]);
  return result;
}

}  // namespace touchstone::perception
