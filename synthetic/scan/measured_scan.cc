#include "synthetic/scan/measured_scan.h"

#include "harness/base/random.h"
#include "harness/recording/combine.h"

namespace touchstone::synthetic {

OutTrajectory MeasuredScan::out_trajectory(double tip_radius_m) const {
  OutTrajectory out;
  for (const ScanTruth& at : truth) {
    out.motion.t_s.push_back(at.t_s);
    out.motion.p_W_m.push_back(at.contact_W_m + (tip_radius_m + at.gap_m) * at.n_W);
    out.motion.q_WS.push_back(at.q_WS);
    out.n_W.push_back(at.n_W);
    out.gap_m.push_back(at.gap_m);
  }
  return out;
}

RenderedTrajectory MeasuredScan::exact_answer(double tip_radius_m, double stiffness_N_per_m) const {
  RenderedTrajectory answer;
  for (const ScanTruth& at : truth) {
    answer.t_s.push_back(at.t_s);
    answer.tip_W_m.push_back(RigidScan::in_trajectory_W_m(at, tip_radius_m, stiffness_N_per_m));
    answer.contact_W_m.push_back(at.contact_W_m + (tip_radius_m + at.gap_m) * at.n_W);
    answer.f_W_N.push_back(at.f_W_N);
    answer.contact.push_back(at.normal_force_N > 0.0 ? 1 : 0);
  }
  return answer;
}

MeasuredScan measure(const RigidScan& scan, const ForceSensor& sensor, const Tracker& tracker, std::uint64_t seed) {
  const Random root(seed);
  MeasuredScan measured;
  measured.force = sensor.measure(
      [&](double t) {
        const ScanTruth at = scan.at(t);
        return Vec3(at.q_WS.conjugate() * at.f_W_N);
      },
      scan.duration_s(), root.stream(0).next_u64());
  measured.pose = tracker.measure(
      [&](double t) {
        const ScanTruth at = scan.at(t);
        return Tracker::Pose{at.p_W_m, at.q_WS};
      },
      scan.duration_s(), root.stream(1).next_u64());

  // The force is turned into the object's frame with the orientation that was measured: the only one an experimenter
  // has.
  const ForceMeasurement& force = measured.force;
  const auto orientation = resample(measured.pose.t_s, measured.pose.measured_WS, force.t_s, ResampleOptions{});
  ForceColumns turned;
  for (std::size_t i = 0; i < force.t_s.size(); ++i) {
    if (!orientation.valid[i]) continue;
    turned.t_s.push_back(force.t_s[i]);
    turned.f_W_N.push_back(orientation.values[i] * force.measured_S_N[i]);
  }
  Combined combined = combine({measured.pose.t_s, measured.pose.measured_W_m, measured.pose.measured_WS}, turned);
  measured.recording = std::move(combined.recording);
  measured.notes = std::move(combined.notes);
  for (const double t : measured.recording.motion.t_s) {
    measured.truth.push_back(scan.at(t - tracker.lag_s));
    measured.truth.back().t_s = t;
  }
  return measured;
}

}  // namespace touchstone::synthetic
