// Which triangles a renderer may walk on by their neighbours alone, and which need the general method.
#pragma once

#include <vector>

#include "harness/surface/mesh_topology.h"
#include "harness/surface/triangle_tree.h"

namespace touchstone::renderers {

// True for a triangle that has area, whose edges and corners are manifold, whose neighbours have area and do not lie
// folded onto it, that no triangle crosses other than its neighbours along the shared edge or corner, and that no
// triangle of another body touches to what counts as flush (flush.h). Rims are regular. Crossings are decided exactly
// (triangle_queries.h). A body here is what hangs together across edges of two triangles.
std::vector<bool> regular_triangles(const surface::TriangleMesh& mesh, const surface::MeshTopology& topology,
                                    const surface::TriangleTree& tree);

}  // namespace touchstone::renderers
