// For tests: what becomes of many simulated sessions: refused, right, or silently wrong.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "acquire.h"
#include "harness/base/error.h"
#include "harness/testing/temporary_folder.h"
#include "simulated_session_for_test.h"

namespace touchstone::acquisition {

struct Outcome {
  bool refused = false;  // or written with a fault, exit status 1
  std::string sentence;
  double position_rms_m = 0.0, position_worst_m = 0.0, force_rms_N = 0.0;
  // Four times the 0.25 mm that tracker (0.14 mm, and its attitude's 1 mrad over the lever of 0.1 m) and registration
  // leave at the tip of an undisturbed session, the worst of 2,000 samples twice that. Force: bias limits of a quarter
  // of the contact force, 0.1 N.
  [[nodiscard]] bool right() const { return position_rms_m < 1e-3 && position_worst_m < 2e-3 && force_rms_N < 0.1; }
};

// Without the mesh the registration is the markers' alone.
inline Outcome acquire_simulated(std::uint64_t seed, Disturbance disturbance, bool mesh = true,
                                 double scan_error_m = 0.0) {
  const testing::TemporaryFolder folder;
  SimulatedSession session(seed, disturbance, scan_error_m);
  Outcome outcome;
  try {
    AcquisitionDescription description = read_description(session.write(folder.path()));
    if (!mesh) description.mesh_file.reset();
    const auto [recording, report] = acquire(description);
    double position2 = 0.0, force2 = 0.0, steady = 0.0;
    for (std::size_t i = 0; i < recording.size(); ++i) {
      const double t = recording.motion.t_s[i];
      const double off = (recording.motion.p_W_m[i] - session.tip(t)).norm();
      position2 += off * off;
      outcome.position_worst_m = std::max(outcome.position_worst_m, off);
      if (!session.steady(t)) continue;
      force2 += (recording.f_W_N[i] - session.contact(t)).squaredNorm();
      steady += 1.0;
    }
    outcome.position_rms_m = std::sqrt(position2 / static_cast<double>(recording.size()));
    outcome.force_rms_N = std::sqrt(force2 / steady);
    outcome.refused = report.contact_in_free_air;
    outcome.sentence = fmt::format("{}", fmt::join(report.notes, "; "));
  } catch (const BadData& refusal) {
    outcome.refused = true;
    outcome.sentence = refusal.what();
  }
  return outcome;
}

struct Outcomes {
  int sessions = 0, refused = 0, wrong = 0;
};

// `sessions` in turn through the disturbances given.
template <class Kinds>
Outcomes acquire_all(std::uint64_t first_seed, int sessions, const Kinds& kinds, double scan_error_m = 0.0) {
  Outcomes all;
  for (int i = 0; i < sessions; ++i) {
    const Disturbance kind = kinds[static_cast<std::size_t>(i) % kinds.size()];
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    const Outcome o = acquire_simulated(seed, kind, true, scan_error_m);
    ++all.sessions;
    all.refused += o.refused;
    all.wrong += !o.refused && !o.right();
    fmt::print("{} {}: {}; position {:.3f} mm RMS, {:.2f} worst, force {:.3f} N; {}\n", seed, name_of(kind),
               o.refused   ? "refused"
               : o.right() ? "right"
                           : "WRONG",
               1e3 * o.position_rms_m, 1e3 * o.position_worst_m, o.force_rms_N, o.sentence);
  }
  fmt::print("{} sessions from seed {}: {} refused, {} silently wrong\n", all.sessions, first_seed, all.refused,
             all.wrong);
  return all;
}

}  // namespace touchstone::acquisition
