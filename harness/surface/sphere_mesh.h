// The regular octahedron about the origin, each triangle split in four by the middles of its edges `levels` times,
// every new corner moved to the sphere: 8 * 4^levels triangles, closed, outward, all corners on the sphere. Coordinates
// in m.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

inline TriangleMesh sphere_mesh(double radius_m, int levels) {
  TriangleMesh mesh;
  mesh.vertices_W_m = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [it, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices_W_m.size()));
      if (added) {
        const Vec3 p = mesh.vertices_W_m[static_cast<std::size_t>(a)] + mesh.vertices_W_m[static_cast<std::size_t>(b)];
        mesh.vertices_W_m.push_back(p.normalized());
      }
      return it->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b);
      const int bc = middle(b, c);
      const int ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& v : mesh.vertices_W_m) v *= radius_m;
  mesh.source = "sphere";
  return mesh;
}

}  // namespace touchstone::surface
