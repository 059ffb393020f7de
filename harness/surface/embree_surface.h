// Fast surface queries on a triangle mesh with Embree 3's bounding volume hierarchy.
//
// Embree works in single precision. Here it only proposes: the mesh is centred and scaled to a unit box, so that its
// precision does not depend on the user's unit or origin, and every triangle's box is padded by more than all rounding
// on the way, so that no triangle that matters is left out. The answer itself is computed from the original coordinates
// in double precision (triangle_queries.h): closest points to rounding, crossings exactly. Signed distance:
// angle-weighted pseudo-normals, see mesh_topology.h.
//
// Cost: logarithmic in the number of triangles while the query point is within about 1000 times the mesh's size; beyond
// a million times its size all triangles are visited. A query point that is not finite gets a SurfacePoint of NaN with
// triangle -1, and no crossing.
#pragma once

#include <memory>

#include "harness/surface/surface.h"

namespace touchstone::surface {

// Vertices with exactly equal coordinates are joined first; triangles keep their number and order. mesh() returns the
// joined mesh. Throws BadData where there is no triangle or an index is out of range.
std::shared_ptr<Surface> make_embree_surface(const TriangleMesh& mesh);

}  // namespace touchstone::surface
