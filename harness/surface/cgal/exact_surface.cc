#include "harness/surface/cgal/exact_surface.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "harness/surface/triangle_surface.h"

namespace touchstone::surface {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
using Rational = CGAL::Exact_rational;
using ExactVec = std::array<Rational, 3>;

Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
ExactVec exact(const Vec3& p) { return {Rational(p.x()), Rational(p.y()), Rational(p.z())}; }
ExactVec operator-(const ExactVec& a, const ExactVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Rational dot(const ExactVec& a, const ExactVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
ExactVec cross(const ExactVec& a, const ExactVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
ExactVec along(const ExactVec& from, const ExactVec& direction, const Rational& t) {
  return {from[0] + t * direction[0], from[1] + t * direction[1], from[2] + t * direction[2]};
}
Vec3 rounded(const ExactVec& v) { return {CGAL::to_double(v[0]), CGAL::to_double(v[1]), CGAL::to_double(v[2])}; }

struct ExactClosest {
  Rational squared_distance;
  ExactVec from_query;
  Feature feature = Feature::face;
  std::uint8_t index = 0;
};

// By the definition: the foot of the perpendicular when it lies strictly within, else the best of the edges.
ExactClosest exact_closest(const std::array<Vec3, 3>& corners, const Vec3& query) {
  const ExactVec q = exact(query);
  const std::array<ExactVec, 3> r{exact(corners[0]) - q, exact(corners[1]) - q, exact(corners[2]) - q};
  const std::array<ExactVec, 3> d{r[1] - r[0], r[2] - r[1], r[0] - r[2]};
  const ExactVec n = cross(d[0], d[1]);
  const Rational n2 = dot(n, n);
  if (n2 > 0 && dot(n, cross(r[0], d[0])) > 0 && dot(n, cross(r[1], d[1])) > 0 && dot(n, cross(r[2], d[2])) > 0) {
    const Rational height = dot(r[0], n) / n2;
    return {height * height * n2, {height * n[0], height * n[1], height * n[2]}, Feature::face, 0};
  }
  ExactClosest best;
  for (std::uint8_t e = 0; e < 3; ++e) {
    const Rational length2 = dot(d[e], d[e]);
    const Rational t = -dot(r[e], d[e]);
    ExactClosest here;
    if (t <= 0) {
      here = {0, r[e], Feature::vertex, e};
    } else if (t >= length2) {
      const auto end = static_cast<std::uint8_t>((e + 1) % 3);
      here = {0, r[end], Feature::vertex, end};
    } else {
      here = {0, along(r[e], d[e], t / length2), Feature::edge, e};
    }
    here.squared_distance = dot(here.from_query, here.from_query);
    if (e == 0 || here.squared_distance < best.squared_distance) best = here;
  }
  return best;
}

class ExactSurface final : public TriangleSurface {
 public:
  explicit ExactSurface(const TriangleMesh& mesh) : TriangleSurface(mesh) {
    triangles_.reserve(mesh_.triangles.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& c = facet(static_cast<std::int32_t>(t)).corners;
      const Kernel::Triangle_3 triangle(to_cgal(c[0]), to_cgal(c[1]), to_cgal(c[2]));
      // The tree's distance query divides by the area. Its edges are edges of its neighbours as well, or else it is
      // visited always.
      if (triangle.is_degenerate()) {
        flat_.push_back(static_cast<std::int32_t>(t));
      } else {
        triangles_.push_back(triangle);
        index_.push_back(static_cast<std::int32_t>(t));
      }
    }
    tree_.insert(triangles_.cbegin(), triangles_.cend());
    tree_.build();
    tree_.do_not_accelerate_distance_queries();
  }

  [[nodiscard]] SurfacePoint closest(const Vec3& p_W_m) const override {
    if (!p_W_m.allFinite()) return no_point(p_W_m);
    std::vector<std::int32_t> candidates = flat_;
    if (!triangles_.empty()) {
      const Kernel::Point_3 q = to_cgal(p_W_m);
      const Kernel::Point_3 hint = triangles_.front()[0];
      const double found = CGAL::squared_distance(q, tree_.closest_point(q, hint));
      // The tree's distance is rounded: whatever is as close within far more than that is a candidate. Its rounding is
      // relative to the coordinates, not to the distance.
      const double size = std::max(
          {bounds_.min().cwiseAbs().maxCoeff(), bounds_.max().cwiseAbs().maxCoeff(), p_W_m.cwiseAbs().maxCoeff()});
      const double radius = std::sqrt(found) * (1.0 + 1e-9) + 1e-12 * size;
      std::vector<Primitive::Id> near;
      tree_.all_intersected_primitives(Kernel::Sphere_3(q, radius * radius), std::back_inserter(near));
      for (const auto& id : near) candidates.push_back(triangle_of(id));
    }
    ExactClosest best;
    std::int32_t triangle = -1;
    for (const std::int32_t t : candidates) {
      ExactClosest here = exact_closest(facet(t).corners, p_W_m);
      if (triangle < 0 || here.squared_distance < best.squared_distance ||
          (here.squared_distance == best.squared_distance && t < triangle)) {
        best = std::move(here);
        triangle = t;
      }
    }
    SurfacePoint point = finish(
        p_W_m, triangle, {CGAL::to_double(best.squared_distance), rounded(best.from_query), best.feature, best.index});
    const ExactVec q = exact(p_W_m);
    point.p_W_m = rounded({q[0] + best.from_query[0], q[1] + best.from_query[1], q[2] + best.from_query[2]});
    // A face's side is that of its exact plane; elsewhere the rounded pseudo-normal is taken as it stands.
    ExactVec normal = exact(point.n_W);
    if (best.feature == Feature::face) {
      const auto& c = facet(triangle).corners;
      normal = cross(exact(c[1]) - exact(c[0]), exact(c[2]) - exact(c[0]));
    }
    point.signed_distance_m = dot(best.from_query, normal) > 0 ? -point.distance_m : point.distance_m;
    return point;
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override {
    if (!a_W_m.allFinite() || !b_W_m.allFinite() || a_W_m == b_W_m || triangles_.empty()) return std::nullopt;
    const Kernel::Point_3 a = to_cgal(a_W_m);
    const Kernel::Point_3 b = to_cgal(b_W_m);
    std::vector<Primitive::Id> cut;
    tree_.all_intersected_primitives(Kernel::Segment_3(a, b), std::back_inserter(cut));
    Rational best;
    bool best_entering = false;
    std::int32_t triangle = -1;
    for (const auto& id : cut) {
      const auto& [u, v, w] = std::array{(*id)[0], (*id)[1], (*id)[2]};
      const auto start = CGAL::orientation(u, v, w, a);
      const auto end = CGAL::orientation(u, v, w, b);
      const bool entering = start != CGAL::NEGATIVE && end == CGAL::NEGATIVE;
      const bool leaving = start != CGAL::POSITIVE && end == CGAL::POSITIVE;
      if (!entering && !leaving) continue;
      const std::int32_t t = triangle_of(id);
      const auto& c = facet(t).corners;
      const ExactVec n = cross(exact(c[1]) - exact(c[0]), exact(c[2]) - exact(c[0]));
      const Rational height = dot(n, exact(a_W_m) - exact(c[0]));
      const Rational fraction = height / (height - dot(n, exact(b_W_m) - exact(c[0])));
      if (triangle < 0 || fraction < best || (fraction == best && t < triangle)) {
        best = fraction;
        best_entering = entering;
        triangle = t;
      }
    }
    if (triangle < 0) return std::nullopt;
    Crossing out = finish(a_W_m, b_W_m, triangle, {CGAL::to_double(best), best_entering});
    out.p_W_m = rounded(along(exact(a_W_m), exact(b_W_m) - exact(a_W_m), best));
    return out;
  }

 private:
  [[nodiscard]] std::int32_t triangle_of(const Primitive::Id& id) const {
    return index_[static_cast<std::size_t>(id - triangles_.cbegin())];
  }

  Triangles triangles_;              // those with area
  std::vector<std::int32_t> index_;  // in the mesh
  std::vector<std::int32_t> flat_;   // those without
  Tree tree_;
};

}  // namespace

bool exact_surface_available() noexcept { return true; }

std::shared_ptr<Surface> make_exact_surface(const TriangleMesh& mesh) { return std::make_shared<ExactSurface>(mesh); }

}  // namespace touchstone::surface
