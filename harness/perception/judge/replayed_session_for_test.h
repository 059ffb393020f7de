// A spring that is pressed or slid over, recorded with the noise of a tracker and a force sensor, and models of it that
// are replayed along its recorded path.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "harness/base/random.h"
#include "harness/perception/judge/judged_conditions.h"
#include "harness/perception/judge/replay_path.h"

namespace touchstone::perception {

inline constexpr double turn_rad = 2.0 * std::numbers::pi;

struct Session {
  double k_N_per_m = 400.0;
  double tracker_m = 0.0;
  bool slides = false;
  double rate_Hz = 1000.0;
};

inline Vec3 place_at(const Session& session, double t) {
  const double deepest_m = 3.0 / session.k_N_per_m;
  const double depth_m = (deepest_m + 0.001) * 0.5 * (1.0 - std::cos(turn_rad * 0.9 * t)) - 0.001;
  if (!session.slides) return {0.0, 0.0, -depth_m};
  // To and fro at a depth that changes slowly, from the air and back.
  const double slow_m = (deepest_m + 0.001) * 0.5 * (1.0 - std::cos(turn_rad * 0.3 * t)) - 0.001;
  return {0.02 * std::sin(turn_rad * 0.7 * t), 0.0, -slow_m};
}

inline Vec3 force_of(const Session& session, const Vec3& p) {
  return {0.0, 0.0, std::max(0.0, -session.k_N_per_m * p.z())};
}

inline recording::Recording recorded(const Session& session, std::uint64_t seed) {
  Random random(seed);
  recording::Recording recording;
  recording.source = "session";
  const auto noise = [&random](double sigma) {
    const double x = random.normal();
    const double y = random.normal();
    return Vec3(sigma * Vec3(x, y, random.normal()));
  };
  for (int i = 0; i < static_cast<int>(10.0 * session.rate_Hz); ++i) {
    const double t = i / session.rate_Hz;
    const Vec3 p = place_at(session, t);
    recording.motion.t_s.push_back(t);
    recording.motion.p_W_m.push_back(p + noise(session.tracker_m));
    recording.f_W_N.push_back(force_of(session, p) + noise(0.005));
  }
  return recording;
}

// The process's own model, and one 30 % too soft, on the real path.
inline JudgedConditions judged_models(const Session& session, std::uint64_t seed) {
  const recording::Recording real = recorded(session, seed);
  const auto path = replay_path(real.motion);
  const auto model = [&](const std::string& name, double share) {
    return RecordingSource{name,
                           [&session, &real, &path, share] {
                             recording::Recording rendered{real.motion, {}, {}, "model"};
                             for (const Vec3& p : path.motion.p_W_m)
                               rendered.f_W_N.push_back(share * force_of(session, p));
                             return rendered;
                           },
                           path.samples};
  };
  const RecordingSource again{"again", [&] { return recorded(session, seed + 1000); }};
  return judge_conditions(real, {again}, {model("right", 1.0), model("soft", 0.7)}, Vec3::UnitZ(), {});
}

}  // namespace touchstone::perception
