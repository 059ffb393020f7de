// The in-trajectory: the path that a virtual probe must take so that its surface contact point follows the
// out-trajectory. Source: Ruffaldi et al. 2006, section 3.1: Hooke's law f_p = -k x (equation 1) gives
//   p_in = p_out - F_n / k   (equation 2)
// with F_n = F_n n, the normal component of the recorded force (out_trajectory.h, rules 4 and 5). Times are the
// out-trajectory's. For a tip that is a ball both are positions of its centre.
//
// For a frictionless scan the way there and back is exact: the point closest to p_in on the (offset) surface is p_out,
// and k times the distance is F_n, as long as F_n / k does not reach the medial axis of the object (where another part
// of the surface is closer; on a mesh that may begin at the nearest edge).
#pragma once

#include "harness/rendering/out_trajectory.h"

namespace touchstone {

// Equation 2 for one sample. `stiffness_N_per_m` > 0.
[[nodiscard]] inline Vec3 in_position(const OutSample& out, double stiffness_N_per_m) {
  return out.p_W_m - (out.normal_force_N / stiffness_N_per_m) * out.n_W;
}

// Equation 2 for all samples. Throws UsageError for a stiffness that is not positive and finite.
InTrajectory synthesize_in_trajectory(const OutTrajectory& out, double stiffness_N_per_m);

// The measured positions as they stand: for a compliant object, into which the real tip does press.
InTrajectory measured_in_trajectory(const Recording& recording);

}  // namespace touchstone
