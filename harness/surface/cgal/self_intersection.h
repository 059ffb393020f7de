// Pairs of triangles that cut through one another, found with CGAL's box intersection and decided by exact predicates.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

// Pairs of triangle indices (the smaller first, sorted) that have more in common than the vertices and edges they
// share:
// - no shared vertex: the triangles meet at all;
// - one: the edge opposite to it of one meets the other;
// - two: they lie in one plane on the same side of their edge (folded onto one another).
// Triangles with the same three vertices are duplicates, not intersections; those without area are left out. Vertices
// are told apart by index: weld_coincident_vertices() first. Nothing when this build has no CGAL.
std::optional<std::vector<std::array<std::int32_t, 2>>> self_intersections(const TriangleMesh& mesh);

}  // namespace touchstone::surface
