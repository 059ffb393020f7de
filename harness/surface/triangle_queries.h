// One triangle against a point or a segment: what every triangle surface is made of.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "harness/base/vec.h"
#include "harness/surface/surface.h"

namespace touchstone {

struct TriangleClosest {
  double squared_distance;
  Vec3 from_query;     // closest point minus query point
  Feature feature;     // face, edge or vertex
  std::uint8_t index;  // of the edge (corner index to the next) or of the corner
};

// The closest point of the triangle to q. `face_normal` is the unit normal, or zero for a triangle without area, which
// is then its longest edge. Exact to rounding relative to the distances between q and the corners.
TriangleClosest closest_on_triangle(const std::array<Vec3, 3>& corners, const Vec3& face_normal, const Vec3& q);

struct TriangleCrossing {
  double fraction;
  bool entering;  // comes from the side that the normal points to
};

// Whether the segment a-b crosses the triangle, decided exactly (exact_predicates.h), so that nothing slips through
// along edges and through vertices. A segment that starts on the triangle and leaves it to either side crosses at
// fraction 0; one that ends on it has not crossed yet; one within its plane does not cross. Hence a path of segments
// crosses once wherever its joints lie.
std::optional<TriangleCrossing> cross_triangle(const std::array<Vec3, 3>& corners, const Vec3& face_normal,
                                               const Vec3& a, const Vec3& b);

}  // namespace touchstone
