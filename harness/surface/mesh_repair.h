// Repairs on request: orientation, and sheets that are to be touched from both sides. Vertices and the first triangles
// keep their number and order.
#pragma once

#include <cstddef>
#include <string>

#include "harness/base/rooms.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

struct OrientedMesh {
  TriangleMesh mesh;
  std::size_t turned = 0;         // triangles whose corners run the other way now
  std::size_t pieces_turned = 0;  // closed pieces that were inside out as a whole
};

// Turns the triangles that face the other way than most of their piece (by area), then the closed pieces that enclose a
// negative volume and do not lie within another (a hollow is inside out rightly). A sheet keeps the side that most of
// it has. Throws BadData with the place for a piece that has no orientation, such as a Moebius strip.
OrientedMesh orient(const TriangleMesh& mesh);

// What was done, as a sentence that names the mesh's source.
std::string orientation_note(const OrientedMesh& repaired);

// Every triangle a second time, from its other side: one-sided proxies then stop at it from either side.
TriangleMesh two_sided(const TriangleMesh& mesh);

}  // namespace touchstone::surface
