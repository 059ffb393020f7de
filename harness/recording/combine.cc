#include "harness/recording/combine.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

std::vector<double> common_times(const MotionColumns& pose, const ForceColumns& force, const CombineOptions& options) {
  const double start_s = std::max(pose.t_s.front(), force.t_s.front());
  const double end_s = std::min(pose.t_s.back(), force.t_s.back());
  if (!(end_s > start_s)) {
    throw BadData(
        fmt::format("pose ({} to {} s) and force ({} to {} s) do not overlap in time; do both clocks count "
                    "from the same instant, in the same unit?",
                    pose.t_s.front(), pose.t_s.back(), force.t_s.front(), force.t_s.back()));
  }
  if (options.times == CommonTimes::uniform) return uniform_times(start_s, end_s, options.rate_Hz);
  const std::vector<double>& source = options.times == CommonTimes::pose ? pose.t_s : force.t_s;
  return {std::ranges::lower_bound(source, start_s), std::ranges::upper_bound(source, end_s)};
}

}  // namespace

Combined combine(const MotionColumns& pose, const ForceColumns& force, const CombineOptions& options) {
  const ClockReport pose_clock = examine_clock(pose.t_s, options.gap_factor);
  const ClockReport force_clock = examine_clock(force.t_s, options.gap_factor);
  if (pose_clock.samples < 2 || force_clock.samples < 2) {
    throw BadData(fmt::format("{} poses and {} forces; at least two of each are needed", pose_clock.samples,
                              force_clock.samples));
  }
  const std::vector<double> times = common_times(pose, force, options);
  const double rate_Hz = options.times == CommonTimes::uniform ? options.rate_Hz
                         : options.times == CommonTimes::pose  ? pose_clock.nominal_rate_Hz
                                                               : force_clock.nominal_rate_Hz;
  ResampleOptions pose_options{.method = options.pose,
                               .longest_gap_s = options.gap_factor * pose_clock.median_interval_s,
                               .target_rate_Hz = rate_Hz,
                               .refuse = options.on_gap == OnGap::refuse};
  ResampleOptions force_options = pose_options;
  force_options.longest_gap_s = options.gap_factor * force_clock.median_interval_s;
  const bool faster = force_clock.nominal_rate_Hz >= 2.0 * rate_Hz;
  force_options.method = faster ? Interpolation::windowed_average : options.force;

  const auto positions = resample(pose.t_s, pose.p_W_m, times, pose_options);
  const auto forces = resample(force.t_s, force.f_W_N, times, force_options);
  Resampled<Quat> rotations;
  if (!pose.q_WS.empty()) rotations = resample(pose.t_s, pose.q_WS, times, pose_options);
  Resampled<Vec3> torques;
  if (!force.torque_W_Nm.empty()) torques = resample(force.t_s, force.torque_W_Nm, times, force_options);

  Combined combined;
  Recording& recording = combined.recording;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (positions.valid[i] == 0 || forces.valid[i] == 0) continue;
    recording.motion.t_s.push_back(times[i]);
    recording.motion.p_W_m.push_back(positions.values[i]);
    recording.f_W_N.push_back(forces.values[i]);
    if (!rotations.values.empty()) recording.motion.q_WS.push_back(rotations.values[i]);
    if (!torques.values.empty()) recording.torque_W_Nm.push_back(torques.values[i]);
  }
  if (recording.size() < 2) {
    throw BadData("pose and force have fewer than two common samples outside gaps; are the clocks right?");
  }
  combined.notes.push_back(
      fmt::format("position: {:.6g} Hz to {:.6g} Hz by {}", pose_clock.nominal_rate_Hz, rate_Hz,
                  options.times == CommonTimes::pose ? "nothing, its own times" : name_of(pose_options.method)));
  if (!rotations.values.empty()) combined.notes.emplace_back("orientation: spherical linear interpolation");
  combined.notes.push_back(
      fmt::format("force: {:.6g} Hz to {:.6g} Hz by {}", force_clock.nominal_rate_Hz, rate_Hz,
                  options.times == CommonTimes::force ? "nothing, its own times" : name_of(force_options.method)));
  if (recording.size() < times.size()) {
    combined.notes.push_back(fmt::format("{} of {} samples left out: they lie in a gap of the pose or of the force",
                                         times.size() - recording.size(), times.size()));
  }
  return combined;
}

}  // namespace touchstone::recording
