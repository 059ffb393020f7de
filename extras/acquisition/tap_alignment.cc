#include "tap_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clock_parts.h"
#include "harness/base/error.h"
#include "harness/stats/distributions.h"
#include "smoothing.h"

namespace touchstone::acquisition {
namespace {

// Fewer give no scatter to judge them by.
constexpr std::size_t fewest_taps = 3, fewest_clusters = 8;

void check_line(const ClockAlignment& line, const TapOptions& options, const std::string& source) {
  if (!line.fit.determined())
    throw BadData(
        fmt::format("{}: the taps that were found do not determine the offset of the clocks; tap four times before and "
                    "four times after scanning, or give the offset (/clocks/offset_s)",
                    source));
  if (std::abs(line.skew) <= options.largest_skew + 2.0 * line.skew_sigma) return;
  throw BadData(
      fmt::format("{}: the clocks differ by {:.0f} ppm, more than the {:.0f} ppm of working clocks; one of the streams "
                  "has lost samples or its times are counted, not measured: record again with time stamps",
                  source, line.skew * 1e6, options.largest_skew * 1e6));
}

// `missing`: of the streams, as missing_in() says it.
[[noreturn]] void too_few_taps(std::size_t contacts, std::size_t taps, const TapOptions& options,
                               const std::string& source, const std::string& missing) {
  if (contacts == 0) {
    throw BadData(fmt::format(
        "{}: no taps in the force (contacts of {} to {} s); tap the object a few times before and after scanning, or "
        "give the offset of the clocks (/clocks/offset_s){}",
        source, options.shortest_tap_s, options.longest_tap_s, missing));
  }
  throw BadData(fmt::format(
      "{}: of {} brief contacts in the force {} are taps in the motion (straight down and up again along "
      "/clocks/tap_normal_W); {} are needed: check that direction, or tap four times before and four "
      "times after scanning, or describe the tool (/tool), so that free motion helps, or give the offset of "
      "the clocks (/clocks/offset_s){}",
      source, contacts, taps, fewest_taps, missing));
}

// A line of no skew, about the middle of the motion.
ClockAlignment near_to(double offset_s, const std::vector<double>& t_motion_s) {
  ClockAlignment line;
  line.reference_s = 0.5 * (t_motion_s.front() + t_motion_s.back());
  line.offset_s = offset_s;
  return line;
}

}  // namespace

ClockAlignment align_by_taps(const std::vector<double>& t_force_s, const std::vector<double>& normal_force_N,
                             const std::vector<double>& t_motion_s, const std::vector<double>& height_m,
                             const TapOptions& options, const std::string& source) {
  std::vector<Vec3> force;
  force.reserve(normal_force_N.size());
  for (const double f : normal_force_N) force.emplace_back(0.0, 0.0, f);
  const auto quick = without_slow_part(t_force_s, force);
  const auto contacts = find_force_taps(t_force_s, normal_force_N, options);
  const auto missing = [&] { return missing_in(t_force_s, "force") + missing_in(t_motion_s, "motion"); };
  if (contacts.empty()) too_few_taps(0, 0, options, source, missing());
  const double coarse = coarse_offset(t_force_s, quick, t_motion_s, height_m, source);
  const auto events =
      tap_events(t_force_s, normal_force_N, t_motion_s, height_m, contacts, coarse, coarse_error_s, 0.0, options);
  if (events.size() < fewest_taps) too_few_taps(contacts.size(), events.size(), options, source, missing());
  const ClockAlignment guess = near_to(coarse, t_motion_s);
  const ClockAlignment line = fit_clock_line(tap_clusters(events, guess, sample_interval_s(t_motion_s)), guess);
  check_line(line, options, source);
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
  const FreeMotion motion(s);
  ClockAlignment line = near_to(motion.offset_near(coarse), s.t_motion_s);
  bool moves = true;
  for (int pass = 0; moves && pass < 3; ++pass) {  // the shift is linearised: again at the line that came out
    const auto clusters = motion.clusters(line);
    moves = clusters.size() >= fewest_clusters;
    if (moves) line = fit_clock_line(clusters, line);
    moves = moves && line.fit.determined();
  }
  if (!moves) line = near_to(coarse, s.t_motion_s);
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
  if (moves) {
    line.taps = taps;
  } else {
    if (taps < fewest_taps) {
      too_few_taps(contacts.size(), taps, options, source,
                   missing_in(s.t_force_s, "force") + missing_in(s.t_motion_s, "motion"));
    }
    line = fit_clock_line(tap_clusters(std::move(events), line, interval), line);
  }
  check_line(line, options, source);
  return line;
}

}  // namespace touchstone::acquisition
