// Repairs on request: seams, orientation, and sheets that are to be touched from both sides. Vertices and the first
// triangles keep their number and order.
#pragma once

#include <cstddef>
#include <string>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

struct OrientedMesh {
  TriangleMesh mesh;
  std::size_t turned = 0;         // triangles whose corners run the other way now
  std::size_t pieces_turned = 0;  // closed pieces that were inside out as a whole
  std::size_t joined = 0;         // corners along open edges that are another one now
  double widest_gap_m = 0.0;      // between two of them
  std::size_t split = 0;          // triangles that have a corner of another one on an edge now
  std::size_t open_edges = 0;     // that are left
};

// Joins corners of open edges where the surfaces of a CAD file meet without touching, within the smallest of 1e-6,
// 1e-5, 1e-4 and 1e-3 of the mesh's diagonal that leaves the fewest open edges; none where a triangle would lose its
// area or an edge would get a third triangle. Then turns the triangles that face the other way than most of their piece
// (by area), then the closed pieces that enclose a negative volume and do not lie within another (a hollow is inside
// out rightly). A sheet keeps the side that most of it has. Throws BadData with the place for a piece that has no
// orientation, such as a Moebius strip.
OrientedMesh orient(const TriangleMesh& mesh);

// Closes the seams of open sheets: along open edges corners within `distance_m` of one another become one, and where
// one lies as near to another triangle's open edge, between its ends (a T-junction), that triangle is split there.
// Triangles that are split keep their place with one part, the other parts follow all. Throws UsageError for a distance
// that is not positive, BadData with the place where a triangle would lose its area.
OrientedMesh weld_seams(const TriangleMesh& mesh, double distance_m);

// What was done, as sentences that name the mesh's source; empty if nothing was.
std::string repair_note(const OrientedMesh& repaired);

// Every triangle a second time, from its other side: one-sided proxies then stop at it from either side.
TriangleMesh two_sided(const TriangleMesh& mesh);

}  // namespace touchstone::surface
