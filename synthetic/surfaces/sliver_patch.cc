#include "synthetic/surfaces/sliver_patch.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::synthetic {

Tessellation SliverPatch::tessellate(std::size_t triangles) const {
  // Two triangles in the middle, eight in every ring; rings come in pairs: a wide one and a sliver.
  const auto pairs = std::max<std::size_t>(1, (triangles + 6) / 16);
  const double smallest = 0.5 * smallest_m_;
  const double growth = std::pow(half_side_m_ / smallest, 1.0 / static_cast<double>(pairs));
  surface::TriangleMesh mesh;
  const auto add_square = [&](double half) {
    for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
      mesh.vertices_W_m.emplace_back(half * x, half * y, 0.0);
    }
  };
  add_square(smallest);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (std::size_t i = 1; i <= 2 * pairs; ++i) {
    const std::size_t pair = (i + 1) / 2;
    const double whole = smallest * std::pow(growth, static_cast<double>(pair));
    // A side is 2 * half long: a gap of side / aspect makes the sliver.
    add_square(i % 2 == 1 ? whole * (1.0 - 2.0 / aspect_) : whole);
    const auto outer = static_cast<std::int32_t>(4 * i);
    for (std::int32_t j = 0; j < 4; ++j) {
      const std::int32_t k = (j + 1) % 4;
      mesh.triangles.push_back({outer + j, outer + k, outer - 4 + k});
      mesh.triangles.push_back({outer + j, outer - 4 + k, outer - 4 + j});
    }
  }
  return {std::move(mesh), 0.0};
}

}  // namespace touchstone::synthetic
