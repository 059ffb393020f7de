// A mesh in another place, attitude and unit.
#pragma once

#include <utility>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

// Scaled about the origin, then turned, then shifted [m].
inline TriangleMesh moved(TriangleMesh mesh, const Quat& turn, const Vec3& shift_m, double scale = 1.0) {
  for (Vec3& v : mesh.vertices_W_m) v = turn * (scale * v) + shift_m;
  return mesh;
}

}  // namespace touchstone::surface
