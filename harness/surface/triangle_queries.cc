#include "harness/surface/triangle_queries.h"

#include <algorithm>
#include <cmath>

#include "harness/surface/exact_predicates.h"

namespace touchstone {

TriangleClosest closest_on_triangle(const std::array<Vec3, 3>& corners, const Vec3& face_normal, const Vec3& q) {
  const std::array<Vec3, 3> r{corners[0] - q, corners[1] - q, corners[2] - q};
  // Not from r: next to a far query point an edge would drown in its rounding.
  const std::array<Vec3, 3> d{corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]};
  // On an edge or a corner the answer is the edge's or the corner's: they have the pseudo-normals.
  const bool inside = face_normal.dot(r[0].cross(d[0])) > 0.0 && face_normal.dot(r[1].cross(d[1])) > 0.0 &&
                      face_normal.dot(r[2].cross(d[2])) > 0.0;
  if (inside) {
    // Measured from the nearest corner: the least rounding.
    const std::array<double, 3> squares{r[0].squaredNorm(), r[1].squaredNorm(), r[2].squaredNorm()};
    const auto nearest = static_cast<std::size_t>(std::min_element(squares.begin(), squares.end()) - squares.begin());
    const double height = r[nearest].dot(face_normal);
    return {height * height, height * face_normal, Feature::face, 0};
  }
  TriangleClosest best{};
  best.squared_distance = -1.0;
  for (std::uint8_t e = 0; e < 3; ++e) {
    const double length2 = d[e].squaredNorm();
    const double along = -r[e].dot(d[e]);
    TriangleClosest here{};
    if (along <= 0.0) {
      here = {0.0, r[e], Feature::vertex, e};
    } else if (along >= length2) {
      const auto end = static_cast<std::uint8_t>((e + 1) % 3);
      here = {0.0, r[end], Feature::vertex, end};
    } else {
      // From the nearer end: the least rounding.
      const Vec3 p = 2.0 * along <= length2 ? Vec3(r[e] + (along / length2) * d[e])
                                            : Vec3(r[(e + 1U) % 3U] - ((length2 - along) / length2) * d[e]);
      here = {0.0, p, Feature::edge, e};
    }
    here.squared_distance = here.from_query.squaredNorm();
    if (best.squared_distance < 0.0 || here.squared_distance < best.squared_distance) best = here;
  }
  return best;
}

std::optional<TriangleCrossing> cross_triangle(const std::array<Vec3, 3>& corners, const Vec3& face_normal,
                                               const Vec3& a, const Vec3& b) {
  const auto& [u, v, w] = corners;
  const int start = side_of_plane(u, v, w, a);
  const int end = side_of_plane(u, v, w, b);
  const bool entering = start >= 0 && end < 0;
  const bool leaving = start <= 0 && end > 0;
  if (!entering && !leaving) return std::nullopt;
  const int first = side_of_plane(a, b, u, v);
  const int second = side_of_plane(a, b, v, w);
  if (first * second < 0) return std::nullopt;
  const int third = side_of_plane(a, b, w, u);
  if (first * third < 0 || second * third < 0) return std::nullopt;
  if (start == 0) return TriangleCrossing{0.0, entering};
  const Vec3 n = face_normal.isZero(0.0) ? Vec3((v - u).cross(w - u)) : face_normal;
  const double height_a = std::abs(n.dot(a - u));
  const double height_b = std::abs(n.dot(b - u));
  const double sum = height_a + height_b;
  return TriangleCrossing{sum > 0.0 ? std::min(height_a / sum, 1.0) : 0.0, entering};
}

}  // namespace touchstone
