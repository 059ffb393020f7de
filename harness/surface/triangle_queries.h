// One triangle against a point or a segment: what every triangle surface is made of.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "harness/base/vec.h"
#include "harness/surface/closest_on_triangle.h"
#include "harness/surface/surface.h"

namespace touchstone::surface {

using TriangleClosest = TriangleClosestOf<double>;

// See closest_on_triangle.h.
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

}  // namespace touchstone::surface
