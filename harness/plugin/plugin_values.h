// Vectors and poses of this library as the C structures of <touchstone/plugin2.h>, and back.
#pragma once

#include <touchstone/plugin2.h>

#include "harness/base/vec.h"

namespace touchstone::plugin {

inline constexpr touchstone2_pose identity_pose{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};

inline void copy(const Vec3& from, double (&to)[3]) noexcept {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}
inline Vec3 vector_of(const double (&values)[3]) noexcept { return {values[0], values[1], values[2]}; }
inline Quat quaternion_of(const double (&wxyz)[4]) noexcept { return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]}; }
inline touchstone2_pose pose_of(const Vec3& p_W_m, const Quat& q) noexcept {
  return {{p_W_m.x(), p_W_m.y(), p_W_m.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

}  // namespace touchstone::plugin
