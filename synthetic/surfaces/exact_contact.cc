#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::synthetic {

ExactContact exact_contact(const Surface& surface, const Vec3& tip_W_m, double stiffness_N_per_m, double tip_radius_m) {
  const SurfacePoint at = surface.closest(tip_W_m);
  const double depth = tip_radius_m - at.signed_distance_m;
  if (depth <= 0.0) return {false, tip_W_m, Vec3::Zero(), 0.0, Vec3::Zero()};
  // Inside, and outside at a smooth point, the offset's normal is the surface's; outside at an edge it points from the
  // edge to the ball's centre.
  const bool outside = at.signed_distance_m > 0.0;
  const Vec3 n = outside ? Vec3((tip_W_m - at.p_W_m) / at.distance_m) : at.n_W;
  return {true, tip_W_m + depth * n, n, depth, stiffness_N_per_m * depth * n};
}

}  // namespace touchstone::synthetic
