#include "axis_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/stats/quantile.h"

namespace touchstone::axis {
namespace {

// Slope of a straight line through the samples within `half` of each sample.
std::vector<double> slopes(const std::vector<double>& t_s, const std::vector<double>& values, std::size_t half) {
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i > half ? i - half : 0, to = std::min(values.size(), i + half + 1);
    double mt = 0.0, mv = 0.0, tv = 0.0, tt = 0.0;
    const auto n = static_cast<double>(to - from);
    for (std::size_t k = from; k < to; ++k) mt += t_s[k] / n, mv += values[k] / n;
    // Least squares: the covariance of time and value over the variance of time.
    for (std::size_t k = from; k < to; ++k) tv += (t_s[k] - mt) * (values[k] - mv), tt += (t_s[k] - mt) * (t_s[k] - mt);
    result[i] = tt > 0.0 ? tv / tt : 0.0;
  }
  return result;
}

}  // namespace

AxisSamples samples_of(const AxisRun& run) {
  constexpr double window_s = 0.05;
  const double interval_s = (run.t_s.back() - run.t_s.front()) / static_cast<double>(run.t_s.size() - 1);
  const auto half = std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(window_s / interval_s)), 1,
                                            std::max<std::size_t>(1, run.t_s.size() / 200));
  AxisSamples s;
  s.t_s = run.t_s, s.place = run.place, s.load = run.load;
  s.rate = run.rate.empty() ? slopes(run.t_s, run.place, half) : run.rate;
  s.acceleration = slopes(run.t_s, s.rate, half);
  std::vector<double> speeds;
  for (const double v : s.rate) speeds.push_back(std::abs(v));
  s.usual_speed = stats::lower_quantile(speeds, 0.9);
  for (std::size_t i = 0; i < run.t_s.size(); ++i) {
    if (run.keep_rest || std::abs(s.rate[i]) > share_at_rest * s.usual_speed) s.used.push_back(i);
  }
  if (s.used.size() < fewest_samples) {
    throw BadData(
        fmt::format("{}: only {} samples move; at least {} are needed", run.source, s.used.size(), fewest_samples));
  }
  s.lowest = s.highest = s.place[s.used.front()];
  for (const std::size_t i : s.used)
    s.lowest = std::min(s.lowest, s.place[i]), s.highest = std::max(s.highest, s.place[i]);
  return s;
}

std::vector<double> directions(const AxisSamples& s, double width, bool backlash) {
  std::vector<double> z(s.place.size());
  const double slow = share_at_rest * s.usual_speed;
  double now = 0.0;
  for (std::size_t i = 0; i < s.place.size() && now == 0.0; ++i) {
    if (std::abs(s.rate[i]) > slow) now = s.rate[i] > 0.0 ? 1.0 : -1.0;
  }
  for (std::size_t i = 0; i < s.place.size(); ++i) {
    // Over the way w of a reversal the sign goes from -1 to 1 in proportion to the way: dz = 2 dq / w (axis_fit.h).
    if (width > 0.0) {
      if (i > 0) now = std::clamp(now + 2.0 * (s.place[i] - s.place[i - 1]) / width, -1.0, 1.0);
    } else if (std::abs(s.rate[i]) > slow) {
      now = s.rate[i] > 0.0 ? 1.0 : -1.0;
    }
    z[i] = backlash && std::abs(now) < 1.0 ? 0.0 : now;
  }
  return z;
}

std::vector<double> high_passed(const AxisSamples& s, double tau_s) {
  std::vector<double> result(s.place.size());
  double slow = s.place.front();
  for (std::size_t i = 1; i < s.place.size(); ++i) {
    // The exact step of q_tau' = (q - q_tau) / tau towards a place that stands still within a sample.
    slow += (s.place[i] - slow) * -std::expm1(-(s.t_s[i] - s.t_s[i - 1]) / tau_s);
    result[i] = s.place[i] - slow;
  }
  return result;
}

AxisHat hat_at(const AxisSamples& s, double place, Eigen::Index knots) {
  // A piecewise linear function is the sum of hats: at a place the two about it weigh 1 - share and share.
  const double at = std::clamp((place - s.lowest) / (s.highest - s.lowest), 0.0, 1.0) * static_cast<double>(knots - 1);
  const auto left = std::min(static_cast<Eigen::Index>(at), knots - 2);
  return {left, at - static_cast<double>(left)};
}

Eigen::MatrixXd design_of(const AxisSamples& s, const AxisStructure& structure, const std::vector<std::size_t>& which) {
  const std::vector<double> z = directions(s, structure.width, structure.backlash);
  const std::vector<double> passed = structure.tau_s > 0.0 ? high_passed(s, structure.tau_s) : std::vector<double>{};
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(which.size()), structure.columns());
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    const std::size_t i = which[static_cast<std::size_t>(row)];
    const AxisHat hat = hat_at(s, s.place[i], structure.knots);
    a(row, hat.left) = 1.0 - hat.share;
    a(row, hat.left + 1) = hat.share;
    // After h at its knots a column for each term that the structure has: dry z, viscous q', inertia q'', relaxing
    // (q - q_tau), and the hats of friction over place times z.
    Eigen::Index column = structure.knots;
    if (structure.dry) a(row, column++) = z[i];
    if (structure.viscous) a(row, column++) = s.rate[i];
    if (structure.inertia) a(row, column++) = s.acceleration[i];
    if (structure.tau_s > 0.0) a(row, column++) = passed[i];
    if (!structure.friction_over_place) continue;
    const AxisHat friction = hat_at(s, s.place[i], friction_knots);
    a(row, column + friction.left) = z[i] * (1.0 - friction.share);
    a(row, column + friction.left + 1) = z[i] * friction.share;
  }
  return a;
}

double knot_place(const AxisSamples& s, Eigen::Index k, Eigen::Index knots) {
  return s.lowest + (s.highest - s.lowest) * static_cast<double>(k) / static_cast<double>(knots - 1);
}

}  // namespace touchstone::axis
