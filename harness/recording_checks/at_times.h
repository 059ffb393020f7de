// A recording's position and force at other times, by straight lines between its samples.
#pragma once

#include "harness/recording/trajectory.h"

namespace touchstone::recording_checks {

// Times must be asked for in increasing order: the walk through the recording only goes forward.
class AtTimes {
 public:
  explicit AtTimes(const recording::Recording& recording) : recording_(recording) {}

  // False outside of the recording.
  bool find(double t_s) {
    const auto& t = recording_.motion.t_s;
    if (t.size() < 2 || t_s < t.front() || t_s > t.back()) return false;
    while (at_ + 2 < t.size() && t[at_ + 1] < t_s) ++at_;
    share_ = (t_s - t[at_]) / (t[at_ + 1] - t[at_]);
    return true;
  }
  [[nodiscard]] Vec3 position_m() const { return between(recording_.motion.p_W_m); }
  [[nodiscard]] Vec3 force_N() const { return between(recording_.f_W_N); }
  // Of the sample before.
  [[nodiscard]] const Quat& orientation() const { return recording_.motion.q_WS[at_]; }

 private:
  [[nodiscard]] Vec3 between(const std::vector<Vec3>& v) const { return v[at_] + share_ * (v[at_ + 1] - v[at_]); }

  const recording::Recording& recording_;
  std::size_t at_ = 0;
  double share_ = 0.0;
};

}  // namespace touchstone::recording_checks
