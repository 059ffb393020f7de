// The static virtual coupling between the handle (what the hand holds) and the proxy (where the tool may be): a spring
// between the two origins and a torsional spring between the two orientations. The wrench that the hand feels is the
// coupling's:
//   f = k_t (p_proxy - p_handle),   tau = k_r log(R_proxy R_handle^T)   about the handle's origin, components in W.
// Its energy k_t |dp|^2 / 2 + k_r |log R|^2 / 2 has this wrench as its gradient.
// Sources: Colgate, Stanley and Brown 1995 (virtual coupling); Wan and McNeely 2003 (static coupling, without mass).
#pragma once

#include "harness/tool/pose.h"

namespace touchstone::tool {

struct Coupling {
  double stiffness_N_per_m = 1000.0;
  double rotational_stiffness_Nm_per_rad = 2.0;
};

inline Wrench coupling_wrench(const Coupling& coupling, const Pose& handle, const Pose& proxy) {
  const Displacement d = displacement(handle, proxy);
  return {coupling.stiffness_N_per_m * d.translation_m, coupling.rotational_stiffness_Nm_per_rad * d.rotation_rad};
}
inline double coupling_energy_J(const Coupling& coupling, const Pose& handle, const Pose& proxy) {
  const Displacement d = displacement(handle, proxy);
  return 0.5 * coupling.stiffness_N_per_m * squared_norm(d.translation_m) +
         0.5 * coupling.rotational_stiffness_Nm_per_rad * squared_norm(d.rotation_rad);
}

}  // namespace touchstone::tool
