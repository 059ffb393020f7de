// A force and a torque about a stated point, and how the torque moves with that point.
#pragma once

#include "harness/base/vec.h"

namespace touchstone {

struct Wrench {
  Vec3 f_N = Vec3::Zero();
  Vec3 torque_Nm = Vec3::Zero();

  [[nodiscard]] bool finite() const noexcept { return f_N.allFinite() && torque_Nm.allFinite(); }
};

// The same load about the point r (given in the wrench's frame, from the old point): T' = T - r x F.
inline Wrench wrench_about(const Wrench& w, const Vec3& r_m) { return {w.f_N, w.torque_Nm - r_m.cross(w.f_N)}; }

// The same wrench with its components in another frame: q turns this frame into that one.
inline Wrench rotated(const Quat& q, const Wrench& w) { return {q * w.f_N, q * w.torque_Nm}; }

}  // namespace touchstone
