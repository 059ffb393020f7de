#include "rigid_scan.h"

#include <cmath>

#include "harness/base/rotations.h"

namespace touchstone::datasets {
namespace {

// A hand holds the probe upright rather than along the normal, and sways.
Quat probe_orientation(const Vec3& n_W, double t_s) {
  const Vec3 sway(0.15 * std::sin(0.9 * t_s + 0.3), 0.12 * std::sin(0.7 * t_s + 1.1), 0.0);
  const Vec3 along = (n_W + 0.8 * Vec3::UnitZ() + sway).normalized();
  return shortest_rotation(Vec3::UnitZ(), along) * Quat(Eigen::AngleAxisd(0.2 * std::sin(0.5 * t_s), Vec3::UnitZ()));
}

}  // namespace

Vec3 RigidScan::touching_centre_W_m(double t_s) const {
  const GuidePoint q = guide_->at(script_.target(t_s));
  return q.p_W_m + contact_.tip_radius_m * q.n_W;
}

ScanTruth RigidScan::at(double t_s) const {
  const ScanScript::Press hand = script_.press(t_s);
  const GuidePoint q = guide_->at(script_.target(t_s));
  ScanTruth truth;
  truth.t_s = t_s;
  truth.contact_W_m = q.p_W_m;
  truth.n_W = q.n_W;
  truth.gap_m = hand.gap_m;
  truth.normal_force_N = hand.normal_force_N;
  truth.p_W_m =
      q.p_W_m + (contact_.tip_radius_m + hand.gap_m - hand.normal_force_N / contact_.stiffness_N_per_m) * q.n_W;
  truth.q_WS = probe_orientation(q.n_W, t_s);
  // Fourth-order central difference: with tremor at 12 Hz and this step its error is below 1e-10 of the speed. Only the
  // tangential part matters, so the touching ball stands for the centre: at rest the difference is exactly zero.
  constexpr double h = 1e-4;
  const Vec3 v = (8.0 * (touching_centre_W_m(t_s + h) - touching_centre_W_m(t_s - h)) -
                  (touching_centre_W_m(t_s + 2.0 * h) - touching_centre_W_m(t_s - 2.0 * h))) /
                 (12.0 * h);
  truth.v_t_W_m_per_s = v - v.dot(q.n_W) * q.n_W;
  const double speed = truth.v_t_W_m_per_s.norm();
  truth.f_W_N = Vec3::Zero();
  if (truth.normal_force_N > 0.0) truth.f_W_N = truth.normal_force_N * q.n_W;
  if (truth.normal_force_N > 0.0 && speed > 0.0)
    truth.f_W_N -= contact_.mu * truth.normal_force_N / speed * truth.v_t_W_m_per_s;
  return truth;
}

Vec3 RigidScan::in_trajectory_W_m(const ScanTruth& truth, double tip_radius_m, double stiffness_N_per_m) {
  const double out = tip_radius_m + truth.gap_m;
  return truth.contact_W_m + (out - truth.normal_force_N / stiffness_N_per_m) * truth.n_W;
}

}  // namespace touchstone::datasets
