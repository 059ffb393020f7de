// The in-trajectory: the path that a virtual probe must take so that its surface contact point follows the
// out-trajectory. Source: Ruffaldi et al. 2006, section 3.1. Times are the out-trajectory's. For a tip that is a ball
// both are positions of its centre.
//
// A penalty-based renderer answers f = k (p_contact - p_in) (Hooke's law, equation 1, x from the contact point to the
// probe). Which p_in makes p_contact = p_out, and f the recorded force, depends on where the renderer puts its contact
// point. With the recorded force F = F_n n + F_t split at p_out into normal and tangential part:
//
//  - Without friction in the proxy the contact point is the closest point of the surface, so that p_contact - p_in is
//    normal there. p_contact = p_out needs p_in = p_out - d n, and f . n = F_n gives d = F_n / k:
//      p_in = p_out - F_n n / k     (equation 2; InTrajectoryMode::synthesize)
//    The answer is F_n n; no frictionless renderer can do better than to leave F_t as its error. So it is also for
//    renderers whose friction is added to the force of a frictionless proxy (the effect coulomb-friction).
//  - With friction in the proxy (the friction cone of Harwin and Melder 2002) the proxy is held back until
//    |f_t| <= mu f_n. Fed equation 2 while it slides, it settles where f_t = mu f_n, that is mu F_n / k behind p_out:
//    the contact point is wrong by that much, and on a curved surface the normal there is turned. The recorded force
//    is its answer at p_contact = p_out only for
//      p_in = p_out - F / k         (InTrajectoryMode::whole_force)
//    which satisfies equation 1 for the whole force. If the object slides with |F_t| = mu F_n, that p_in lies on the
//    border of the cone at p_out, and the proxy stays there.
//  - Fed the whole force, a frictionless renderer has its contact point |F_t| / k beside p_out (on a plane; its force
//    is then the same F_n n). So neither input is right for both kinds, and results of different inputs are not
//    compared (harness/report/rendered_input.h).
//
// For a frictionless scan both are the same and the way there and back is exact: the point closest to p_in on the
// (offset) surface is p_out, and k times the distance is F_n, as long as F_n / k does not reach the medial axis of the
// object (where another part of the surface is closer; on a mesh that may begin at the nearest edge).
#pragma once

#include <span>

#include "harness/recording/dataset.h"
#include "harness/rendering/out_trajectory.h"

namespace touchstone::rendering {

// Equation 2 for one sample. `stiffness_N_per_m` > 0.
[[nodiscard]] inline Vec3 in_position(const OutSample& out, double stiffness_N_per_m) {
  return out.p_W_m - (out.normal_force_N / stiffness_N_per_m) * out.n_W;
}

// One sample by `mode`, recorded at `p_W_m` with the force `f_W_N` on the probe. Off the surface, and where the force
// does not push outward at the contact, there is no penetration: p_in = p_out. The stiffness is not used by `measured`.
[[nodiscard]] inline Vec3 in_position(const OutSample& out, const Vec3& p_W_m, const Vec3& f_W_N,
                                      double stiffness_N_per_m, recording::InTrajectoryMode mode) {
  if (mode == recording::InTrajectoryMode::measured) return p_W_m;
  if (mode == recording::InTrajectoryMode::whole_force && out.normal_force_N > 0.0)
    return out.p_W_m - f_W_N / stiffness_N_per_m;
  return in_position(out, stiffness_N_per_m);
}

// Equation 2 for all samples. Throws UsageError for a stiffness that is not positive and finite.
recording::InTrajectory synthesize_in_trajectory(const recording::OutTrajectory& out, double stiffness_N_per_m);

// The same with the whole recorded force, `f_W_N` one for each sample.
recording::InTrajectory whole_force_in_trajectory(const recording::OutTrajectory& out, std::span<const Vec3> f_W_N,
                                                  double stiffness_N_per_m);

// The measured positions as they stand: for a compliant object, into which the real tip does press.
recording::InTrajectory measured_in_trajectory(const recording::Recording& recording);

// The depth in the object of a tip that feels a force, and that force: medians over the samples that push with more
// than default_contact_threshold_N; NaN where fewer than five do. And the white noise of that depth, by fourth
// differences (of which no movement of a hand is left); 0 where no five of those samples follow one another.
struct DepthUnderForce {
  double depth_m = 0.0;
  double force_N = 0.0;
  double noise_m = 0.0;

  // Stiffer than what a hand takes for rigid: 15 to 42 kN/m (Tan, Srinivasan, Eberman and Cheng 1994, "Human factors
  // for the design of force-reflecting haptic interfaces"), as far as the tracker shows a depth at all: where it is
  // right to no more than it scatters, the first two standard deviations of a depth are its own. Along such a path as
  // it was measured a model answers with next to nothing.
  [[nodiscard]] bool is_rigid() const noexcept { return force_N >= 41.5e3 * (depth_m - 2.0 * noise_m); }
};
DepthUnderForce depth_under_force(const recording::Recording& recording, const surface::Surface& surface,
                                  double tip_radius_m);

}  // namespace touchstone::rendering
