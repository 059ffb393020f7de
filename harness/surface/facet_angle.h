// How far the normals of a triangulation's facets lie from those of the smooth surface that they stand for.
#pragma once

#include <cstdint>
#include <span>

#include "harness/base/rooms.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

// Median over the given triangles (those that were touched; one may be given many times) of the mean angle between the
// facet's normal and the area-weighted normals at its corners, halved: the normal of the smooth surface at a random
// place of the facet is off by about half of that at the corners. The median, so that sharp edges of a body do not
// count. 0 for no triangles.
double median_facet_angle_rad(const TriangleMesh& mesh, std::span<const std::int32_t> triangles);

}  // namespace touchstone::surface
