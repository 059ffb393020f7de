// The box between two corners as a closed mesh of twelve triangles with outward orientation. Coordinates in m.
#pragma once

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

inline TriangleMesh box_mesh(const Vec3& low, const Vec3& high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_W_m.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                                   (i & 4) != 0 ? high.z() : low.z());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  mesh.source = "box";
  return mesh;
}

}  // namespace touchstone::surface
