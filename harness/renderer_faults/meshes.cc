#include "harness/renderer_faults/meshes.h"

#include <cmath>
#include <utility>

namespace touchstone::renderer_faults {
using surface::TriangleMesh;

TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  const auto first = static_cast<std::int32_t>(a.vertices_W_m.size());
  mesh.vertices_W_m.insert(mesh.vertices_W_m.end(), b.vertices_W_m.begin(), b.vertices_W_m.end());
  for (const auto& [i, j, k] : b.triangles) mesh.triangles.push_back({first + i, first + j, first + k});
  mesh.source = a.source + " and " + b.source;
  return mesh;
}

TriangleMesh nested_sheet(double h, double smallest_m) {
  TriangleMesh mesh;
  mesh.source = "nested sheet";
  // A ring of eight corners at half-width w, counter-clockwise from (1, 0).
  constexpr std::array<std::pair<int, int>, 8> ring{
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  double w = h;
  std::int32_t outer = 0;
  const auto add_ring = [&] {
    const auto first = static_cast<std::int32_t>(mesh.vertices_W_m.size());
    for (const auto& [x, y] : ring) mesh.vertices_W_m.emplace_back(w * x, w * y, 0.0);
    return first;
  };
  add_ring();
  while (w > smallest_m) {
    w *= 0.5;
    const std::int32_t inner = add_ring();
    for (std::int32_t i = 0; i < 8; ++i) {
      const std::int32_t next = (i + 1) % 8;
      // The diagonal goes from the ring's corner, so that no angle gets small.
      if (i % 2 == 0) {
        mesh.triangles.push_back({outer + i, outer + next, inner + next});
        mesh.triangles.push_back({outer + i, inner + next, inner + i});
      } else {
        mesh.triangles.push_back({outer + i, outer + next, inner + i});
        mesh.triangles.push_back({outer + next, inner + next, inner + i});
      }
    }
    outer = inner;
  }
  const auto middle = static_cast<std::int32_t>(mesh.vertices_W_m.size());
  mesh.vertices_W_m.push_back(Vec3::Zero());
  for (std::int32_t i = 0; i < 8; ++i) mesh.triangles.push_back({middle, outer + i, outer + (i + 1) % 8});
  return mesh;
}

TriangleMesh roof(double h, double angle_rad) {
  TriangleMesh mesh;
  mesh.source = "roof";
  const double end = -h * std::tan(angle_rad);
  const std::array<std::pair<double, double>, 6> profile{
      {{-h, -h}, {0.0, -h}, {h, -h}, {h, end}, {0.0, 0.0}, {-h, 0.0}}};
  for (const double y : {-h, h}) {
    for (const auto& [x, z] : profile) mesh.vertices_W_m.emplace_back(x, y, z);
  }
  for (std::int32_t i = 0; i < 6; ++i) {
    const std::int32_t next = (i + 1) % 6;
    mesh.triangles.push_back({i, 6 + i, next});
    mesh.triangles.push_back({next, 6 + i, 6 + next});
  }
  // The profile runs counter-clockwise in x and z, which is seen so from -y: the end at -y as it is, the other turned.
  const std::array<std::array<std::int32_t, 3>, 4> front{{{0, 1, 5}, {1, 4, 5}, {1, 2, 4}, {2, 3, 4}}};
  for (const auto& [a, b, c] : front) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({6 + a, 6 + c, 6 + b});
  }
  return mesh;
}

}  // namespace touchstone::renderer_faults
