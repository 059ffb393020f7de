// A polygon of any shape as triangles, by its ears: a corner whose triangle holds no other corner is cut off, until
// three are left; every simple polygon has two (G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82,
// 1975).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::surface::mesh_readers {

struct Ears {
  std::vector<std::array<std::size_t, 3>> triangles;  // places in the polygon, in its orientation
  bool folded = false;  // it crosses itself, or is folded: some triangles are turned over, whatever the cut
};

// `corners` in order, seen along Newell's normal; they need not lie in one plane. Always corners.size() - 2 triangles.
Ears cut_ears(std::span<const Vec3> corners);

}  // namespace touchstone::surface::mesh_readers
