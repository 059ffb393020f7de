#include "harness/acquisition/tap_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/acquisition/clock_parts.h"
#include "harness/acquisition/smoothing.h"
#include "harness/base/error.h"
#include "harness/stats/distributions.h"

namespace touchstone::acquisition {
namespace {

using Event = ClockAlignment::Event;

constexpr double ordinary_skew = 100e-6;  // what quartz clocks differ by

// Fewer give no scatter to judge them by.
constexpr std::size_t fewest_taps = 3, fewest_stretches = 5;

ClockAlignment fit_once(std::vector<Event> events) {
  ClockAlignment line;
  const auto n = static_cast<double>(events.size());
  double sum = 0.0;
  for (const Event& e : events) {
    const double weight = 1.0 / (e.sigma_s * e.sigma_s);
    sum += weight;
    line.reference_s += weight * e.motion_s;
  }
  line.reference_s /= sum;
  double s_tt = 0.0, s_td = 0.0;
  for (const Event& e : events) {
    const double weight = 1.0 / (e.sigma_s * e.sigma_s), t = e.motion_s - line.reference_s, d = e.force_s - e.motion_s;
    line.offset_s += weight * d / sum;
    s_tt += weight * t * t;
    s_td += weight * t * d;
  }
  line.offset_sigma_s = 1.0 / std::sqrt(sum);
  line.skew_sigma = s_tt > 0.0 ? 1.0 / std::sqrt(s_tt) : ordinary_skew;
  // A skew that is known no better than clocks keep time anyway would only add error.
  line.skew_fitted = events.size() >= 3 && line.skew_sigma < ordinary_skew;
  if (line.skew_fitted) line.skew = s_td / s_tt;
  for (Event& e : events) {
    e.residual_s = e.force_s - line.to_force_clock(e.motion_s);
    line.residual_rms_s += e.residual_s * e.residual_s / n;
  }
  line.residual_rms_s = std::sqrt(line.residual_rms_s);
  line.degrees = std::max(1.0, n - (line.skew_fitted ? 2.0 : 1.0));
  line.events = std::move(events);
  return line;
}

// What the events scatter about the line, in units of their sigmas.
double scatter_of(const ClockAlignment& line) {
  double chi = 0.0;
  for (const Event& e : line.events) chi += std::pow(e.residual_s / e.sigma_s, 2);
  return std::sqrt(chi / line.degrees);
}

// A line over events of one kind, their sigmas scaled to the scatter that they show.
ClockAlignment weighed(std::vector<Event> events, double interval_s) {
  ClockAlignment line = fit_clock_line(std::move(events), interval_s);
  const double scale = line.events.size() > 2 ? scatter_of(line) : 1.0;
  if (!(scale > 0.0)) return line;
  for (Event& e : line.events) e.sigma_s *= scale;
  return fit_once(std::move(line.events));
}

void check_skew(const ClockAlignment& line, const TapOptions& options, const std::string& source) {
  if (std::abs(line.skew) <= options.largest_skew + 2.0 * line.skew_sigma) return;
  throw BadData(
      fmt::format("{}: the clocks differ by {:.0f} ppm, more than the {:.0f} ppm of working clocks; one of the streams "
                  "has lost samples or its times are counted, not measured: record again with time stamps",
                  source, line.skew * 1e6, options.largest_skew * 1e6));
}

[[noreturn]] void too_few_taps(std::size_t contacts, std::size_t taps, const TapOptions& options,
                               const std::string& source) {
  if (contacts == 0) {
    throw BadData(fmt::format(
        "{}: no taps in the force (contacts of {} to {} s); tap the object a few times before and after scanning, or "
        "give the offset of the clocks (/clocks/offset_s)",
        source, options.shortest_tap_s, options.longest_tap_s));
  }
  throw BadData(fmt::format(
      "{}: of {} brief contacts in the force {} are taps in the motion (straight down and up again along "
      "/clocks/tap_normal_W); {} are needed: check that direction, or tap four times before and four "
      "times after scanning, or describe the tool (/tool), so that free motion helps, or give the offset of "
      "the clocks (/clocks/offset_s)",
      source, contacts, taps, fewest_taps));
}

}  // namespace

ClockAlignment fit_clock_line(std::vector<Event> events, double interval_s) {
  // The worst event goes while it lies beyond four of its sigmas, of the others' scatter, and 0.15 samples.
  constexpr double far = 4.0, small_part = 0.15;
  ClockAlignment line = fit_once(std::move(events));
  while (line.events.size() > 4) {
    const auto ratio = [](const Event& e) { return std::abs(e.residual_s) / e.sigma_s; };
    const auto worst = std::max_element(line.events.begin(), line.events.end(),
                                        [&](const Event& a, const Event& b) { return ratio(a) < ratio(b); });
    std::vector<Event> others = line.events;
    others.erase(others.begin() + std::distance(line.events.begin(), worst));
    ClockAlignment without = fit_once(std::move(others));
    const double miss = std::abs(worst->force_s - without.to_force_clock(worst->motion_s));
    if (miss < far * worst->sigma_s * std::max(1.0, scatter_of(without)) || miss < small_part * interval_s) break;
    line = std::move(without);
  }
  return line;
}

double ClockAlignment::sigma_at(double t_motion_s) const {
  return std::hypot(offset_sigma_s, (skew_fitted ? skew_sigma : ordinary_skew) * (t_motion_s - reference_s));
}

double ClockAlignment::interval95_at(double t_motion_s) const {
  return stats::student_t_975(degrees) * sigma_at(t_motion_s);
}

ClockAlignment align_by_taps(const std::vector<double>& t_force_s, const std::vector<double>& normal_force_N,
                             const std::vector<double>& t_motion_s, const std::vector<double>& height_m,
                             const TapOptions& options, const std::string& source) {
  std::vector<Vec3> force;
  force.reserve(normal_force_N.size());
  for (const double f : normal_force_N) force.emplace_back(0.0, 0.0, f);
  const auto quick = without_slow_part(t_force_s, force);
  const auto contacts = find_force_taps(t_force_s, normal_force_N, options);
  if (contacts.empty()) too_few_taps(0, 0, options, source);
  const double coarse = coarse_offset(t_force_s, quick, t_motion_s, height_m, source);
  const auto events =
      tap_events(t_force_s, normal_force_N, t_motion_s, height_m, contacts, coarse, coarse_error_s, 0.0, options);
  if (events.size() < fewest_taps) too_few_taps(contacts.size(), events.size(), options, source);
  ClockAlignment line = weighed(events, sample_interval_s(t_motion_s));
  line.taps = line.events.size();
  check_skew(line, options, source);
  return line;
}

ClockAlignment align_clocks(const ClockStreams& s, const TapOptions& options, const std::string& source) {
  std::vector<double> height;
  height.reserve(s.tip_T_m.size());
  for (const Vec3& p : s.tip_T_m) height.push_back(s.normal_T.dot(p));
  const double interval = sample_interval_s(s.t_motion_s);
  const double coarse =
      coarse_offset(s.t_force_s, without_slow_part(s.t_force_s, s.force_S_N), s.t_motion_s, height, source);
  // Free motion first, if the tool is known: it needs neither contacts nor a direction.
  ClockAlignment line;
  line.offset_s = free_motion_offset(s, coarse);
  std::vector<Event> stretches;
  for (int pass = 0; pass < 2; ++pass) {  // the shift is linearised: once more at the line that came out
    auto events = free_motion_events(s, line);
    if (events.size() < fewest_stretches) break;
    line = weighed(std::move(events), interval);
    stretches = line.events;
  }
  const bool moves = !stretches.empty();
  if (!moves) line.offset_s = coarse;
  // The normal's component of what the surface does, by the orientation at that offset.
  std::vector<double> t, at_motion, normal_force;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < s.t_force_s.size(); ++i) {
    const double at = line.to_motion_clock(s.t_force_s[i]);
    if (at >= s.t_motion_s.front() && at <= s.t_motion_s.back())
      at_motion.push_back(at), index.push_back(i), t.push_back(s.t_force_s[i]);
  }
  const auto q = slerp_at(s.t_motion_s, s.q_TS, at_motion, source);
  normal_force.reserve(index.size());
  for (std::size_t i = 0; i < index.size(); ++i) {
    const Vec3 contact_S =
        contact_wrench_at_tip({s.force_S_N[index[i]], Vec3::Zero()}, s.tool, q[i], s.gravity_T_m_per_s2, s.tip_S_m).f_N;
    normal_force.push_back(s.normal_T.dot(q[i] * contact_S));
  }
  const auto contacts = find_force_taps(t, normal_force, options);
  auto events = tap_events(t, normal_force, s.t_motion_s, height, contacts, line.offset_s,
                           moves ? interval : coarse_error_s, s.tool.mass_kg, options);
  const std::size_t taps = events.size();
  if (!moves) {
    if (taps < fewest_taps) too_few_taps(contacts.size(), taps, options, source);
    line = weighed(std::move(events), interval);
  }
  line.taps = moves ? taps : line.events.size();
  line.free_motion = stretches.size();
  check_skew(line, options, source);
  return line;
}

}  // namespace touchstone::acquisition
