#include "measured_scan.h"

#include <functional>

#include "harness/base/random.h"
#include "harness/recording/combine.h"

namespace touchstone::datasets {

recording::OutTrajectory MeasuredScan::out_trajectory(double tip_radius_m) const {
  recording::OutTrajectory out;
  for (const ScanTruth& at : truth) {
    out.motion.t_s.push_back(at.t_s);
    out.motion.p_W_m.push_back(at.contact_W_m + (tip_radius_m + at.gap_m) * at.n_W);
    out.motion.q_WS.push_back(at.q_WS);
    out.n_W.push_back(at.n_W);
    out.gap_m.push_back(at.gap_m);
  }
  return out;
}

recording::RenderedTrajectory MeasuredScan::exact_answer(double tip_radius_m, double stiffness_N_per_m) const {
  recording::RenderedTrajectory answer;
  for (const ScanTruth& at : truth) {
    answer.t_s.push_back(at.t_s);
    answer.tip_W_m.push_back(RigidScan::in_trajectory_W_m(at, tip_radius_m, stiffness_N_per_m));
    answer.contact_W_m.push_back(at.contact_W_m + (tip_radius_m + at.gap_m) * at.n_W);
    answer.f_W_N.push_back(at.f_W_N);
    answer.contact.push_back(at.normal_force_N > 0.0 ? 1 : 0);
  }
  return answer;
}

namespace {

// Probe and object as the tracker sees them in the world, the probe brought into the object's frame by what was
// measured.
PoseMeasurement measure_on_moving(const Tracker& tracker, const std::function<Tracker::Pose(double)>& probe_B,
                                  Tracker::Pose (*object_pose)(double t_s), double duration_s, const Random& root) {
  PoseMeasurement probe = tracker.measure(
      [&](double t) {
        const Tracker::Pose object = object_pose(t);
        const Tracker::Pose in_object = probe_B(t);
        return Tracker::Pose{object.p_W_m + object.q_WS * in_object.p_W_m, object.q_WS * in_object.q_WS};
      },
      duration_s, root.stream(1).next_u64());
  const PoseMeasurement object = tracker.measure(object_pose, duration_s, root.stream(2).next_u64());
  for (std::size_t i = 0; i < probe.t_s.size(); ++i) {
    const Quat back = object.measured_WS[i].conjugate();
    probe.measured_W_m[i] = back * (probe.measured_W_m[i] - object.measured_W_m[i]);
    probe.measured_WS[i] = back * probe.measured_WS[i];
  }
  return probe;
}

}  // namespace

MeasuredScan measure(const RigidScan& scan, const ForceSensor& sensor, const Tracker& tracker, std::uint64_t seed,
                     Tracker::Pose (*object_pose)(double t_s)) {
  const Random root(seed);
  MeasuredScan measured;
  measured.force = sensor.measure(
      [&](double t) {
        const ScanTruth at = scan.at(t);
        return Vec3(at.q_WS.conjugate() * at.f_W_N);
      },
      scan.duration_s(), root.stream(0).next_u64());
  const auto probe = [&](double t) {
    const ScanTruth at = scan.at(t);
    return Tracker::Pose{at.p_W_m, at.q_WS};
  };
  measured.pose = object_pose != nullptr ? measure_on_moving(tracker, probe, object_pose, scan.duration_s(), root)
                                         : tracker.measure(probe, scan.duration_s(), root.stream(1).next_u64());

  // The force is turned into the object's frame with the orientation that was measured: the only one an experimenter
  // has.
  const ForceMeasurement& force = measured.force;
  const auto orientation =
      resample(measured.pose.t_s, measured.pose.measured_WS, force.t_s, recording::ResampleOptions{});
  recording::ForceColumns turned;
  for (std::size_t i = 0; i < force.t_s.size(); ++i) {
    if (!orientation.valid[i]) continue;
    turned.t_s.push_back(force.t_s[i]);
    turned.f_W_N.push_back(orientation.values[i] * force.measured_S_N[i]);
  }
  recording::Combined combined =
      combine({measured.pose.t_s, measured.pose.measured_W_m, measured.pose.measured_WS}, turned);
  measured.recording = std::move(combined.recording);
  measured.notes = std::move(combined.notes);
  for (const double t : measured.recording.motion.t_s) {
    measured.truth.push_back(scan.at(t - tracker.lag_s));
    measured.truth.back().t_s = t;
  }
  return measured;
}

}  // namespace touchstone::datasets
