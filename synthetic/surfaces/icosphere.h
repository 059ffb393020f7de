// The icosahedron subdivided to any frequency and pushed out to a star-shaped body: 20 n^2 triangles of nearly equal
// size, closed, outward oriented, no T-junctions.
#pragma once

#include <cstddef>
#include <functional>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::synthetic {

// `radius_m` gives the distance from the origin in a direction (unit vector).
surface::TriangleMesh icosphere(std::size_t triangles, const std::function<double(const Vec3&)>& radius_m);

// The longest edge of a mesh, for deviation bounds.
double longest_edge_m(const surface::TriangleMesh& mesh);

}  // namespace touchstone::synthetic
