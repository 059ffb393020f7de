// Continues a mesh with open edges outward: a scan of a part of an object ends where the scanner did, but the object
// does not, and a probe that presses near the end of the mesh must not slip over an edge that is not there.
//
// 1. Holes and notches narrower than `width_m`: where an open edge turns inward, triangles are added between neighbours
//    on it, shortest first (ear cutting), as long as they look the way the surface does there (within 60 degrees). A
//    hole is closed by that.
// 2. The outline is continued along the tangent plane at it by `width_m`, perpendicular to the outline.
// A mesh without open edges stays as it is. What is added is a guess (a plane through the edge), good for a width that
// is small beside the radii of curvature.
#pragma once

#include <span>

#include "harness/surface/mesh_topology.h"
#include "harness/surface/surface.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

// `mesh`'s vertices and triangles stay the first of the result. Throws UsageError for a width that is not positive and
// finite, BadData where edges have more than two triangles or disagree in orientation.
TriangleMesh extend_open_edges(const TriangleMesh& mesh, double width_m);

// The share of the tips whose closest surface point lies on an open edge: where probe and object touched, but the mesh
// has ended. 0 without tips. `topology` is that of the surface's mesh.
double share_at_open_edges(const Surface& surface, const MeshTopology& topology, std::span<const Vec3> tips_W_m);

}  // namespace touchstone::surface
