// Where taps begin: in the force signal, and in the motion.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "harness/acquisition/hinge.h"
#include "harness/acquisition/smoothing.h"
#include "harness/acquisition/tap_alignment.h"
#include "harness/stats/quantile.h"

namespace touchstone::acquisition {
namespace {

// Baseline of the free air: the lower half of the samples belongs to it as long as the probe is off the surface for
// half of the time; where it is not, the quietest tenth does.
struct Baseline {
  double level_N;
  double noise_N;
};

Baseline baseline_of(const std::vector<double>& force) {
  // Windows of 50 samples; the one tenth with the least spread are free air or still contact: take the lowest level.
  constexpr std::size_t window = 50;
  std::vector<std::pair<double, double>> windows;  // level, spread
  for (std::size_t i = 0; i + window <= force.size(); i += window) {
    double mean = 0.0, square = 0.0;
    for (std::size_t j = i; j < i + window; ++j) mean += force[j];
    mean /= window;
    for (std::size_t j = i; j < i + window; ++j) square += (force[j] - mean) * (force[j] - mean);
    windows.emplace_back(mean, std::sqrt(square / (window - 1)));
  }
  if (windows.empty()) return {0.0, 0.0};
  std::vector<double> levels;
  levels.reserve(windows.size());
  for (const auto& [level, spread] : windows) levels.push_back(level);
  std::sort(levels.begin(), levels.end());
  const double low = levels[levels.size() / 20];
  const double high = levels[levels.size() - 1 - levels.size() / 100];
  std::vector<double> near_levels, near_spreads;
  for (const auto& [level, spread] : windows) {
    if (level <= low + 0.05 * (high - low)) near_levels.push_back(level), near_spreads.push_back(spread);
  }
  return {stats::upper_median(std::move(near_levels)), stats::upper_median(std::move(near_spreads))};
}

struct Edge {
  double at_s;
  double sigma_s;
};

// The edge of a tap between 10 and 40 % of its peak, extended down to the baseline: `step` -1 walks from the peak back
// to the onset, +1 on to the release.
Edge edge_of(const std::vector<double>& t, const std::vector<double>& force, std::size_t peak, int step,
             const Baseline& base) {
  const double height = force[peak] - base.level_N;
  const double origin = t[peak];
  double n = 0, st = 0, sf = 0, stt = 0, stf = 0;
  std::size_t i = peak;
  for (; i > 0 && i + 1 < t.size(); i = step < 0 ? i - 1 : i + 1) {
    const double f = force[i] - base.level_N;
    if (f < 0.1 * height) break;
    if (f > 0.4 * height) continue;
    const double u = t[i] - origin;
    n += 1, st += u, sf += f, stt += u * u, stf += u * f;
  }
  const double determinant = n * stt - st * st;
  if (n >= 3 && determinant > 0) {
    const double slope = (n * stf - st * sf) / determinant;
    const double level = (sf - slope * st) / n;
    if (slope * step < 0) {
      const double spread = std::pow(st / n + level / slope, 2) * n / determinant;
      return {origin - level / slope, base.noise_N / std::abs(slope) * std::sqrt(1.0 / n + spread)};
    }
  }
  return {t[i], std::max(std::abs(t[i] - origin),
                         sample_interval_s({t[i > 0 ? i - 1 : 0], t[i]}))};  // an edge within two samples
}

ForceTap tap_of(const std::vector<double>& t, const std::vector<double>& force, std::size_t first, std::size_t last,
                const Baseline& base) {
  const auto begin = force.begin() + static_cast<std::ptrdiff_t>(first),
             end = force.begin() + static_cast<std::ptrdiff_t>(last);
  const auto peak = static_cast<std::size_t>(std::distance(force.begin(), std::max_element(begin, end)));
  const Edge onset = edge_of(t, force, peak, -1, base), release = edge_of(t, force, peak, +1, base);
  return {onset.at_s, onset.sigma_s, release.at_s, release.sigma_s, force[peak] - base.level_N};
}

}  // namespace

std::vector<ForceTap> find_force_taps(const std::vector<double>& t_s, const std::vector<double>& normal_force_N,
                                      const TapOptions& options) {
  const Baseline base = baseline_of(normal_force_N);
  double threshold = options.force_threshold_N;
  if (threshold <= 0.0) {
    const double largest =
        normal_force_N.empty() ? 0.0 : *std::max_element(normal_force_N.begin(), normal_force_N.end()) - base.level_N;
    threshold = std::max(8.0 * base.noise_N, 0.1 * largest);
  }
  std::vector<ForceTap> taps;
  if (!(threshold > 0.0)) return taps;
  // Hysteresis: in above the threshold, out below half of it.
  std::size_t first = 0;
  bool inside = false;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    const double f = normal_force_N[i] - base.level_N;
    if (!inside && f > threshold) {
      inside = true;
      first = i;
    } else if (inside && f < 0.5 * threshold) {
      inside = false;
      const double duration = t_s[i] - t_s[first];
      if (duration <= options.longest_tap_s && duration >= options.shortest_tap_s)
        taps.push_back(tap_of(t_s, normal_force_N, first, i, base));
    }
  }
  return taps;
}

std::vector<MotionStop> find_motion_stops(const std::vector<double>& t_s, const std::vector<double>& height_m,
                                          const TapOptions& options) {
  std::vector<MotionStop> stops;
  constexpr std::size_t before = 3, after = 2;
  const std::size_t n = t_s.size();
  if (n < before + after + 2) return stops;
  const auto speed = [&](std::size_t from, std::size_t to) {
    return (height_m[to] - height_m[from]) / (t_s[to] - t_s[from]);
  };
  std::vector<double> descents;
  for (std::size_t i = before; i < n; ++i) descents.push_back(std::max(0.0, -speed(i - before, i)));
  std::vector<double> sorted = descents;
  std::sort(sorted.begin(), sorted.end());
  const double fast = sorted[sorted.size() - 1 - sorted.size() / 200];
  if (!(fast > 0.0)) return stops;
  // A stop: the descent's speed drops to less than half within two samples. Of neighbours the sharpest counts.
  const auto sharpness = [&](std::size_t i) { return speed(i, i + after) - speed(i - before, i); };
  for (std::size_t i = before; i + after < n; ++i) {
    const double approach = -speed(i - before, i);
    if (approach < 0.2 * fast || -speed(i, i + after) > 0.5 * approach) continue;
    bool sharpest = true;
    for (std::size_t j = i > before + 3 ? i - 3 : before; j <= std::min(i + 3, n - 1 - after); ++j)
      sharpest &= sharpness(j) <= sharpness(i);
    if (!sharpest) continue;
    stops.push_back(fit_hinge(t_s, height_m, t_s[i], t_s[i] + 2.5 * (t_s[i + 1] - t_s[i]), options.approach_s));
  }
  return stops;
}

MotionStop fit_hinge(const std::vector<double>& t_s, const std::vector<double>& height_m, double stop_guess_s,
                     double level_until_s, double approach_s) {
  MotionStop stop;
  stop.stop_s = stop_guess_s;
  const double interval = sample_interval_s(t_s);
  stop.stop_sigma_s = interval;
  const auto first = static_cast<std::size_t>(
      std::distance(t_s.begin(), std::lower_bound(t_s.begin(), t_s.end(), stop_guess_s - approach_s)));
  const auto last =
      static_cast<std::size_t>(std::distance(t_s.begin(), std::upper_bound(t_s.begin(), t_s.end(), level_until_s)));
  if (last - first < 5) return stop;
  // The straight part of the approach: backwards from the stop while the speed stays above three quarters of the
  // fastest stretch.
  auto guess =
      static_cast<std::size_t>(std::distance(t_s.begin(), std::lower_bound(t_s.begin(), t_s.end(), stop_guess_s)));
  guess = std::clamp(guess, first + 1, last - 1);
  double fastest = 0.0;
  std::size_t begin = guess;
  for (std::size_t i = guess; i >= first + 2; --i) {
    const double speed = (height_m[i - 2] - height_m[i]) / (t_s[i] - t_s[i - 2]);
    fastest = std::max(fastest, speed);
    if (guess - i >= 2 && speed < 0.8 * fastest) break;
    begin = i - 1;  // not i - 2: the stretch may begin before the straight part does
  }
  const std::size_t n = last - begin;
  if (n < 5) return stop;
  // Given t0 the model is linear in (level, slope): minimise over t0 by a fine scan and a parabola through its minimum.
  const auto cost = [&](double t0, double* slope) {
    double sb = 0, sbb = 0, sh = 0, sbh = 0, shh = 0;
    for (std::size_t i = begin; i < last; ++i) {
      const double b = std::max(0.0, t0 - t_s[i]), h = height_m[i] - height_m[last - 1];
      sb += b, sbb += b * b, sh += h, sbh += b * h, shh += h * h;
    }
    const auto count = static_cast<double>(n);
    const double determinant = count * sbb - sb * sb;
    if (!(determinant > 0.0)) return std::numeric_limits<double>::infinity();
    const double s = (count * sbh - sb * sh) / determinant, level = (sh - s * sb) / count;
    if (slope != nullptr) *slope = s;
    return shh - level * sh - s * sbh;
  };
  constexpr int steps = 60;
  const double span = 2.0 * interval;
  double best = std::numeric_limits<double>::infinity(), at = stop_guess_s;
  for (int k = -steps; k <= steps; ++k) {
    const double t0 = stop_guess_s + span * k / steps;
    if (const double c = cost(t0, nullptr); c < best) best = c, at = t0;
  }
  double step = span / steps;
  for (int refine = 0; refine < 30; ++refine, step *= 0.6) {
    for (const double t0 : {at - step, at + step}) {
      if (const double c = cost(t0, nullptr); c < best) best = c, at = t0;
    }
  }
  double slope = 0.0;
  cost(at, &slope);
  if (!(slope > 0.0) || !std::isfinite(best)) return stop;
  stop.stop_s = at;
  stop.approach_m_per_s = slope;
  // Covariance of (level, slope, t0) from the Jacobian at the minimum.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (std::size_t i = begin; i < last; ++i) {
    const double b = std::max(0.0, at - t_s[i]);
    const Eigen::Vector3d row(1.0, b, b > 0.0 ? slope : 0.0);
    normal += row * row.transpose();
  }
  const double variance = std::max(0.0, best) / static_cast<double>(n > 3 ? n - 3 : 1);
  // Not below a ten-thousandth of the way between samples: exact heights must not count infinitely.
  stop.height_rms_m = std::max(std::sqrt(variance), 1e-4 * slope * interval);
  const Eigen::Matrix3d covariance = normal.inverse();
  if (covariance.allFinite() && covariance(2, 2) > 0.0)
    stop.stop_sigma_s = stop.height_rms_m * std::sqrt(covariance(2, 2));
  return stop;
}

}  // namespace touchstone::acquisition
