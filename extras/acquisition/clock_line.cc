// The line between the clocks through taps or free motion, and how well it is known.
#include <algorithm>
#include <cmath>
#include <limits>

#include "clock_parts.h"
#include "harness/stats/distributions.h"
#include "tap_alignment.h"

namespace touchstone::acquisition {
namespace {

using Event = ClockAlignment::Event;

constexpr double ordinary_skew = 100e-6;  // what quartz clocks differ by

double weight_of(const Event& e) { return 1.0 / (e.sigma_s * e.sigma_s); }

// A line through events as they are, for the search for those that are far off.
ClockAlignment plain_line(std::vector<Event> events) {
  ClockAlignment line;
  double sum = 0.0;
  for (const Event& e : events) {
    sum += weight_of(e);
    line.reference_s += weight_of(e) * e.motion_s;
  }
  line.reference_s /= sum;
  double s_tt = 0.0, s_td = 0.0;
  for (const Event& e : events) {
    const double t = e.motion_s - line.reference_s, d = e.force_s - e.motion_s;
    line.offset_s += weight_of(e) * d / sum;
    s_tt += weight_of(e) * t * t;
    s_td += weight_of(e) * t * d;
  }
  // A skew that is known no better than clocks keep time anyway would only add error.
  line.skew_fitted = events.size() >= 3 && s_tt > 1.0 / (ordinary_skew * ordinary_skew);
  if (line.skew_fitted) line.skew = s_td / s_tt;
  line.degrees = std::max(1.0, static_cast<double>(events.size()) - (line.skew_fitted ? 2.0 : 1.0));
  for (Event& e : events) e.residual_s = e.force_s - line.to_force_clock(e.motion_s);
  line.events = std::move(events);
  return line;
}

// What the events scatter about the line, in units of their sigmas.
double scatter_of(const ClockAlignment& line) {
  double chi = 0.0;
  for (const Event& e : line.events) chi += std::pow(e.residual_s / e.sigma_s, 2);
  return std::sqrt(chi / line.degrees);
}

// The same rows with the skew's correction held at a value, and no longer a parameter.
NormalEquations with_skew_at(const NormalEquations& whole, double correction) {
  const Eigen::Index rest = whole.right.size() - 2;
  NormalEquations part{Eigen::MatrixXd(rest + 1, rest + 1), Eigen::VectorXd(rest + 1)};
  part.normal(0, 0) = whole.normal(0, 0);
  part.normal.row(0).tail(rest) = whole.normal.row(0).tail(rest);
  part.normal.col(0).tail(rest) = whole.normal.col(0).tail(rest);
  part.normal.bottomRightCorner(rest, rest) = whole.normal.bottomRightCorner(rest, rest);
  part.right[0] = whole.right[0] - whole.normal(0, 1) * correction;
  part.right.tail(rest) = whole.right.tail(rest) - whole.normal.col(1).tail(rest) * correction;
  return part;
}

// The information's mean time: where an offset alone says most.
double middle_of(const std::vector<Event>& events) {
  double sum = 0.0, when = 0.0;
  for (const Event& e : events) sum += weight_of(e), when += weight_of(e) * e.motion_s;
  return when / sum;
}

}  // namespace

ClockAlignment line_through(std::vector<Event> events, double interval_s) {
  // The worst event goes while it lies beyond four of its sigmas, of the others' scatter, and 0.15 samples.
  constexpr double far = 4.0, small_part = 0.15;
  ClockAlignment line = plain_line(std::move(events));
  while (line.events.size() > 4) {
    const auto ratio = [](const Event& e) { return std::abs(e.residual_s) / e.sigma_s; };
    const auto worst = std::max_element(line.events.begin(), line.events.end(),
                                        [&](const Event& a, const Event& b) { return ratio(a) < ratio(b); });
    std::vector<Event> others = line.events;
    others.erase(others.begin() + std::distance(line.events.begin(), worst));
    ClockAlignment without = plain_line(std::move(others));
    const double miss = std::abs(worst->force_s - without.to_force_clock(worst->motion_s));
    if (miss < far * worst->sigma_s * std::max(1.0, scatter_of(without)) || miss < small_part * interval_s) break;
    line = std::move(without);
  }
  return line;
}

std::vector<ClockCluster> tap_clusters(std::vector<Event> events, const ClockAlignment& near, double interval_s) {
  std::vector<ClockCluster> clusters;
  for (const Event& tap : line_through(std::move(events), interval_s).events) {
    const Eigen::Vector2d row(1.0, (tap.motion_s - near.reference_s) / clock_time_unit_s);
    const double off = tap.force_s - near.to_force_clock(tap.motion_s);
    clusters.push_back({{weight_of(tap) * row * row.transpose(), weight_of(tap) * off * row}, tap, 0.0});
  }
  return clusters;
}

ClockAlignment fit_clock_line(const std::vector<ClockCluster>& clusters, const ClockAlignment& near) {
  ClockAlignment line;
  line.fitted_about_s = near.reference_s;
  double duration_s = 0.0;
  std::vector<NormalEquations> equations;
  for (const ClockCluster& c : clusters) {
    line.events.push_back(c.event);
    equations.push_back(c.equations);
    duration_s += c.duration_s;
    line.taps += !c.event.free_motion;
  }
  line.free_motion = static_cast<std::size_t>(std::lround(duration_s));
  line.fit = ClusteredFit(equations);
  line.skew_sigma = ordinary_skew;
  if (line.fit.determined() && line.events.size() >= 3) {
    Eigen::VectorXd skew = Eigen::VectorXd::Zero(line.fit.estimate().size());
    skew[1] = 1.0 / clock_time_unit_s;
    line.skew_sigma = line.fit.error_of(skew).sigma;
    // A skew that is known no better than clocks keep time anyway would only add error.
    line.skew_fitted = line.skew_sigma < ordinary_skew;
  }
  if (line.skew_fitted) {
    // Where offset and skew are uncorrelated.
    const auto& covariance = line.fit.inverse_normal();
    line.reference_s = near.reference_s - clock_time_unit_s * covariance(0, 1) / covariance(1, 1);
    line.skew = near.skew + line.fit.estimate()[1] / clock_time_unit_s;
  } else {
    // No skew is assumed: what the nearby line had of it, from an earlier pass, goes too.
    for (auto& e : equations) e = with_skew_at(e, -near.skew * clock_time_unit_s);
    line.fit = ClusteredFit(std::move(equations));
    line.skew_sigma = ordinary_skew;
    line.reference_s = middle_of(line.events);
    line.skew = 0.0;
  }
  const double moved_s = line.reference_s - near.reference_s;
  line.offset_s = near.offset_s + line.skew * moved_s;
  if (line.fit.determined()) {
    line.offset_s += line.fit.estimate()[0];
  } else {
    line.offset_sigma_s = std::numeric_limits<double>::infinity();
  }
  const auto error = line.error_at(line.reference_s);
  line.offset_sigma_s = error.sigma;
  line.degrees = error.degrees;
  // The sigmas were right up to a common factor.
  double sum = 0.0, square = 0.0;
  for (Event& e : line.events) {
    e.residual_s = e.force_s - line.to_force_clock(e.motion_s);
    sum += weight_of(e);
    square += weight_of(e) * e.residual_s * e.residual_s;
  }
  line.residual_rms_s = std::sqrt(square / sum);
  const double scale = std::sqrt(square / std::max(1.0, static_cast<double>(line.events.size()) - 2.0));
  if (scale > 0.0) {
    for (Event& e : line.events) e.sigma_s *= scale;
  }
  return line;
}

ClusteredFit::Error ClockAlignment::error_at(double t_motion_s) const {
  if (!fit.determined()) return {std::hypot(offset_sigma_s, skew_sigma * (t_motion_s - reference_s)), 1.0};
  Eigen::VectorXd contrast = Eigen::VectorXd::Zero(fit.estimate().size());
  contrast[0] = 1.0;
  if (skew_fitted) contrast[1] = (t_motion_s - fitted_about_s) / clock_time_unit_s;
  auto error = fit.error_of(contrast);
  if (!skew_fitted) error.sigma = std::hypot(error.sigma, ordinary_skew * (t_motion_s - reference_s));
  return error;
}

double ClockAlignment::sigma_at(double t_motion_s) const { return error_at(t_motion_s).sigma; }

double ClockAlignment::interval95_at(double t_motion_s) const {
  const auto error = error_at(t_motion_s);
  return stats::student_t_975(error.degrees) * error.sigma;
}

}  // namespace touchstone::acquisition
