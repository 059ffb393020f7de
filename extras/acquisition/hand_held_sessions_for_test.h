// For tests: many sessions with the hand-held probe, and how well their alignment and its interval did.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "hand_held_probe_for_test.h"
#include "harness/base/error.h"

namespace touchstone::acquisition {

struct SessionTally {
  int sessions = 0, refused = 0;
  int covered_middle = 0, covered_start = 0, covered_end = 0;                            // by the 95 % interval
  double worst_s = 0.0, mean_error_s = 0.0, rms_error_s = 0.0, mean_half_width_s = 0.0;  // at the reference time
};

inline SessionTally align_sessions(std::uint64_t first_seed, int sessions, const ProbePlan& plan) {
  SessionTally tally;
  int aligned = 0;
  for (int i = 0; i < sessions; ++i) {
    HandHeldProbe probe(first_seed + static_cast<std::uint64_t>(i), plan);
    const ProbeSession s = probe.run();
    ++tally.sessions;
    try {
      const ClockAlignment a =
          align_clocks(s.streams, {}, fmt::format("session {}", first_seed + static_cast<std::uint64_t>(i)));
      const auto error = [&](double t) { return a.to_force_clock(t) - s.true_force_time(t); };
      const auto covered = [&](double t) { return std::abs(error(t)) < a.interval95_at(t); };
      const double middle = error(a.reference_s);
      ++aligned;
      tally.covered_middle += covered(a.reference_s);
      tally.covered_start += covered(0.0);
      tally.covered_end += covered(s.length_s);
      tally.worst_s = std::max(tally.worst_s, std::abs(middle));
      tally.mean_error_s += middle;
      tally.rms_error_s += middle * middle;
      tally.mean_half_width_s += a.interval95_at(a.reference_s);
    } catch (const BadData& refusal) {
      ++tally.refused;
      fmt::print("{}\n", refusal.what());
    }
  }
  const double n = std::max(1, aligned);
  tally.mean_error_s /= n;
  tally.rms_error_s = std::sqrt(tally.rms_error_s / n);
  tally.mean_half_width_s /= n;
  fmt::print(
      "{} sessions from seed {}: {} refused; 95 % interval covers {:.1f} % in the middle, {:.1f} % at the start, "
      "{:.1f} % "
      "at the end; error {:+.3f} ms mean, {:.3f} ms RMS, {:.3f} ms at worst; half width {:.3f} ms\n",
      tally.sessions, first_seed, tally.refused, 100 * tally.covered_middle / n, 100 * tally.covered_start / n,
      100 * tally.covered_end / n, 1e3 * tally.mean_error_s, 1e3 * tally.rms_error_s, 1e3 * tally.worst_s,
      1e3 * tally.mean_half_width_s);
  return tally;
}

}  // namespace touchstone::acquisition
