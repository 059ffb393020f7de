#include "harness/surface/cgal/self_intersection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>

namespace touchstone::surface {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Corners = std::array<std::int32_t, 3>;

class Checker {
 public:
  explicit Checker(const TriangleMesh& mesh) : mesh_(mesh) {
    points_.reserve(mesh.vertices_W_m.size());
    for (const Vec3& v : mesh.vertices_W_m) points_.emplace_back(v.x(), v.y(), v.z());
  }

  [[nodiscard]] Kernel::Triangle_3 triangle(std::int32_t t) const {
    const Corners& c = mesh_.triangles[static_cast<std::size_t>(t)];
    return {point(c[0]), point(c[1]), point(c[2])};
  }

  [[nodiscard]] bool intersect(std::int32_t s, std::int32_t t) const {
    Corners a = mesh_.triangles[static_cast<std::size_t>(s)];
    Corners b = mesh_.triangles[static_cast<std::size_t>(t)];
    // Shared corners to the front of both.
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = shared; j < 3; ++j) {
        if (a[i] != b[j]) continue;
        std::swap(a[shared], a[i]);
        std::swap(b[shared], b[j]);
        ++shared;
        break;
      }
    }
    switch (shared) {
      case 0:
        return CGAL::do_intersect(triangle(s), triangle(t));
      case 1:
        return CGAL::do_intersect(Kernel::Segment_3(point(a[1]), point(a[2])), triangle(t)) ||
               CGAL::do_intersect(Kernel::Segment_3(point(b[1]), point(b[2])), triangle(s));
      case 2:
        return CGAL::orientation(point(a[0]), point(a[1]), point(a[2]), point(b[2])) == CGAL::COPLANAR &&
               CGAL::coplanar_orientation(point(a[0]), point(a[1]), point(a[2]), point(b[2])) == CGAL::POSITIVE;
      default:
        return false;
    }
  }

 private:
  [[nodiscard]] const Kernel::Point_3& point(std::int32_t vertex) const {
    return points_[static_cast<std::size_t>(vertex)];
  }

  const TriangleMesh& mesh_;
  std::vector<Kernel::Point_3> points_;
};

}  // namespace

std::optional<std::vector<std::array<std::int32_t, 2>>> self_intersections(const TriangleMesh& mesh) {
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;
  const Checker checker(mesh);
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto index = static_cast<std::int32_t>(t);
    const Kernel::Triangle_3 triangle = checker.triangle(index);
    if (!triangle.is_degenerate()) boxes.emplace_back(triangle.bbox(), index);
  }
  std::vector<std::array<std::int32_t, 2>> pairs;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    if (checker.intersect(a.info(), b.info()))
      pairs.push_back({std::min(a.info(), b.info()), std::max(a.info(), b.info())});
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace touchstone::surface
