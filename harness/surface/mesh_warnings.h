// What is wrong with a mesh that is about to be rendered, for those who did not ask: what `touchstone doctor` says that
// matters, a line each.
#pragma once

#include <string>
#include <vector>

#include "harness/surface/surface.h"

namespace touchstone::surface {

// For the surface's mesh, empty where there is none: triangles turned inside out, closed pieces that are inside out,
// triangles without area or twice there, edges and vertices that are not manifold, each with the number, the first
// place and what it does. Open edges only where there are few beside the number of triangles: holes, not the rim of a
// sheet. Self-intersection is not looked for (bodies may be put together from parts that overlap). A sound mesh costs
// one walk over its triangles, on the topology that the surface has.
std::vector<std::string> mesh_warnings(const Surface& surface);

// What the reader did to make triangles of the file, a line each with the first place.
std::vector<std::string> reading_notes(const TriangleMesh& mesh);

}  // namespace touchstone::surface
