#include "harness/surface/triangle_queries.h"

#include <algorithm>
#include <cmath>

#include "harness/surface/exact_predicates.h"

namespace touchstone::surface {

TriangleClosest closest_on_triangle(const std::array<Vec3, 3>& corners, const Vec3& face_normal, const Vec3& q) {
  return closest_on_triangle_of<double>(corners, face_normal, q);
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

}  // namespace touchstone::surface
