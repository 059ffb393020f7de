// The closest point of a triangle, over any scalar: what the surfaces use with double (triangle_queries.h), and what
// counts its operations with harness/base/counted.h. The same bits with both.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "harness/base/vec.h"
#include "harness/surface/surface.h"

namespace touchstone::surface {

template <class S>
struct TriangleClosestOf {
  S squared_distance;
  Vec3Of<S> from_query;  // closest point minus query point
  Feature feature;       // face, edge or vertex
  std::uint8_t index;    // of the edge (corner index to the next) or of the corner
};

// `face_normal` is the unit normal, or zero for a triangle without area, which is then its longest edge. Exact to
// rounding relative to the distances between q and the corners.
template <class S>
TriangleClosestOf<S> closest_on_triangle_of(const std::array<Vec3Of<S>, 3>& corners, const Vec3Of<S>& face_normal,
                                            const Vec3Of<S>& q) {
  using V = Vec3Of<S>;
  const std::array<V, 3> r{corners[0] - q, corners[1] - q, corners[2] - q};
  // Not from r: next to a far query point an edge would drown in its rounding.
  const std::array<V, 3> d{corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]};
  // On an edge or a corner the answer is the edge's or the corner's: they have the pseudo-normals.
  const S none(0.0);
  const bool inside = dot(face_normal, r[0].cross(d[0])) > none && dot(face_normal, r[1].cross(d[1])) > none &&
                      dot(face_normal, r[2].cross(d[2])) > none;
  if (inside) {
    // Measured from the nearest corner: the least rounding.
    const std::array<S, 3> squares{squared_norm(r[0]), squared_norm(r[1]), squared_norm(r[2])};
    const auto nearest = static_cast<std::size_t>(std::min_element(squares.begin(), squares.end()) - squares.begin());
    const S height = dot(r[nearest], face_normal);
    return {height * height, height * face_normal, Feature::face, 0};
  }
  TriangleClosestOf<S> best{};
  best.squared_distance = S(-1.0);
  for (std::uint8_t e = 0; e < 3; ++e) {
    const S length2 = squared_norm(d[e]);
    const S along = -dot(r[e], d[e]);
    TriangleClosestOf<S> here{};
    if (along <= none) {
      here = {none, r[e], Feature::vertex, e};
    } else if (along >= length2) {
      const auto end = static_cast<std::uint8_t>((e + 1) % 3);
      here = {none, r[end], Feature::vertex, end};
    } else {
      // From the nearer end: the least rounding.
      const V p = S(2.0) * along <= length2 ? V(r[e] + (along / length2) * d[e])
                                            : V(r[(e + 1U) % 3U] - ((length2 - along) / length2) * d[e]);
      here = {none, p, Feature::edge, e};
    }
    here.squared_distance = squared_norm(here.from_query);
    if (best.squared_distance < none || here.squared_distance < best.squared_distance) best = here;
  }
  return best;
}

}  // namespace touchstone::surface
