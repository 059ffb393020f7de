// For tests: the god-object of a point tip by exhaustion. Slow and without any of the structures of surface_walk.h: no
// neighbours, no tree; in every move all triangles are asked whether they hold the god-object and whether they are in
// the way. Reports when a move over the surface would pass through another triangle, which must not happen on a mesh
// that does not cross itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "harness/surface/mesh_topology.h"

namespace touchstone::renderers {

class GodObjectReference {
 public:
  explicit GodObjectReference(const surface::TriangleMesh& mesh)
      : mesh_(mesh), normals_(make_topology(mesh).face_normals) {}

  void start(const Vec3& p) {
    g_ = p;
    simplex_.clear();
  }
  // The god-object for the next position of the tip.
  const Vec3& follow(const Vec3& p) {
    for (int move = 0; move < 100000; ++move) {
      if (once(p)) return g_;
    }
    failed_ = true;
    return g_;
  }
  [[nodiscard]] bool touching() const { return !simplex_.empty(); }
  [[nodiscard]] bool failed() const { return failed_; }    // did not come to rest
  [[nodiscard]] bool crossed() const { return crossed_; }  // a move over the surface met another triangle

 private:
  using Index = std::int32_t;
  struct Way {
    Vec3 direction = Vec3::Zero();  // the projection of p - g on a triangle's tangent cone at g
    std::set<Index> along;          // corners of the triangle, or of the edge that it runs along
    Vec3 pseudo_normal = Vec3::Zero();
    double height = 0.0;  // of p over the triangle's plane
    bool face = false;
  };

  const Vec3& vertex(Index i) const { return mesh_.vertices_W_m[static_cast<std::size_t>(i)]; }
  // The same numbers as the walk's: what is tested is the way, not the cross product.
  const Vec3& normal(std::size_t t) const { return normals_[t]; }
  double height(std::size_t t, const Vec3& x) const { return normal(t).dot(x - vertex(mesh_.triangles[t][0])); }
  static bool holds(const std::array<Index, 3>& triangle, const std::set<Index>& simplex) {
    return std::all_of(simplex.begin(), simplex.end(),
                       [&](Index i) { return std::count(triangle.begin(), triangle.end(), i) > 0; });
  }
  static std::set<Index> all(const std::array<Index, 3>& t) { return {t[0], t[1], t[2]}; }

  // Distance of x from the triangle's edge e, in its plane, positive inside.
  double inside(std::size_t t, std::size_t e, const Vec3& x) const {
    const auto& c = mesh_.triangles[t];
    return normal(t).cross(vertex(c[(e + 1) % 3]) - vertex(c[e])).normalized().dot(x - vertex(c[e]));
  }

  bool once(const Vec3& p) {
    if (simplex_.empty()) return fly(p);
    const Vec3 d = p - g_;
    Way best;
    double reach = 0.0;
    Vec3 around = Vec3::Zero();  // the pseudo-normal at the simplex itself
    for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
      const auto& c = mesh_.triangles[t];
      if (!holds(c, simplex_)) continue;
      const Vec3 n = normal(t);
      // The triangle's tangent cone at g is bounded by those of its edges that hold g.
      bool within = true;
      for (std::size_t e = 0; e < 3; ++e) {
        const std::set<Index> edge{c[e], c[(e + 1) % 3]};
        if (std::includes(edge.begin(), edge.end(), simplex_.begin(), simplex_.end()))
          within = within && inside(t, e, p) >= 0.0;
      }
      const double h = height(t, p);
      const Vec3 flat = d - n.dot(d) * n;
      if (within && flat.norm() > reach) {
        reach = flat.norm();
        best = {flat, all(c), n, h, true};
      }
      if (simplex_.size() == 1) {
        const Index v = *simplex_.begin();
        const auto i = static_cast<std::size_t>(std::find(c.begin(), c.end(), v) - c.begin());
        const Vec3 u = vertex(c[(i + 1) % 3]) - vertex(v);
        const Vec3 w = vertex(c[(i + 2) % 3]) - vertex(v);
        around += std::atan2(u.cross(w).norm(), u.dot(w)) * n;
        for (const Index to : {c[(i + 1) % 3], c[(i + 2) % 3]}) consider_edge(v, to, d, best, reach);
      } else {
        around += n;
        if (simplex_.size() == 2) {
          consider_edge(*simplex_.begin(), *simplex_.rbegin(), d, best, reach);
          consider_edge(*simplex_.rbegin(), *simplex_.begin(), d, best, reach);
        }
      }
    }
    if (simplex_.size() == 3)
      return height(triangle_of(simplex_), p) >= 0.0 ? fly(p) : over_face(p, triangle_of(simplex_));
    const bool outside =
        reach > 0.0 ? (best.face ? best.height >= 0.0 : best.pseudo_normal.dot(d) > 0.0) : around.dot(d) > 0.0;
    if (outside) return fly(p);
    if (reach == 0.0) return true;
    return best.face ? over_face(p, triangle_of(best.along)) : over_edge(p, best);
  }

  void consider_edge(Index from, Index to, const Vec3& d, Way& best, double& reach) const {
    const Vec3 u = vertex(to) - vertex(from);
    const double rate = d.dot(u) / u.norm();
    if (!(rate > reach)) return;
    Vec3 pseudo = Vec3::Zero();
    for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (holds(mesh_.triangles[t], {from, to})) pseudo += normal(t);
    }
    reach = rate;
    best = {rate * u.normalized(), {from, to}, pseudo, 0.0, false};
  }

  std::size_t triangle_of(const std::set<Index>& corners) const {
    for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (all(mesh_.triangles[t]) == corners) return t;
    }
    return 0;
  }
  bool over_face(const Vec3& p, std::size_t t) {
    const auto& c = mesh_.triangles[t];
    const Vec3 goal = p + -height(t, p) * normal(t);
    double first = 1.0;
    std::size_t exit = 3;
    for (std::size_t e = 0; e < 3; ++e) {
      const double there = inside(t, e, p);
      if (there >= 0.0) continue;
      const double here = std::max(0.0, inside(t, e, g_));
      if (here / (here - there) < first) {
        first = here / (here - there);
        exit = e;
      }
    }
    if (exit == 3) {
      look_out(goal);
      g_ = goal;
      simplex_ = all(c);
      return true;
    }
    const Vec3 next = g_ + first * (goal - g_);
    look_out(next);
    g_ = next;
    simplex_ = {c[exit], c[(exit + 1) % 3]};
    return false;
  }

  bool over_edge(const Vec3& p, const Way& way) {
    const Index from = *way.along.begin();
    const Index to = *way.along.rbegin();
    const Vec3 u = vertex(to) - vertex(from);
    const double after = (p - vertex(from)).dot(u);
    const double before = (p - vertex(to)).dot(-u);
    if (after <= 0.0 || before <= 0.0) {
      const Index end = after <= 0.0 ? from : to;
      if (simplex_ == std::set<Index>{end}) return true;
      look_out(vertex(end));
      g_ = vertex(end);
      simplex_ = {end};
      return false;
    }
    // From the foot on the edge a face may still lead down: only if none does is this the end.
    const Vec3 foot = vertex(from) + after / (after + before) * u;
    look_out(foot);
    const bool there = simplex_ == way.along && (foot - g_).norm() <= 1e-14 * foot.norm();
    g_ = foot;
    simplex_ = way.along;
    return there;
  }

  bool fly(const Vec3& p) {
    double first = 1.0;
    std::size_t hit = mesh_.triangle_count();
    for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (!simplex_.empty() && holds(mesh_.triangles[t], simplex_)) continue;
      if (const double fraction = meets(t, g_, p); fraction < first) {
        first = fraction;
        hit = t;
      }
    }
    if (hit == mesh_.triangle_count()) {
      g_ = p;
      simplex_.clear();
      return true;
    }
    g_ += first * (p - g_);
    simplex_ = all(mesh_.triangles[hit]);
    return false;
  }

  // The fraction of a-b at which it meets the triangle's front; 2 where it does not.
  double meets(std::size_t t, const Vec3& a, const Vec3& b) const {
    const double from = height(t, a);
    const double to = height(t, b);
    if (!(from >= -1e-15 * a.norm() && to < 0.0 && from > to)) return 2.0;
    const double fraction = std::max(0.0, from / (from - to));
    const Vec3 x = a + fraction * (b - a);
    for (std::size_t e = 0; e < 3; ++e) {
      if (inside(t, e, x) < 0.0) return 2.0;
    }
    return fraction;
  }

  // Whether the move over the surface passes well inside through a triangle that does not hold the god-object.
  void look_out(const Vec3& next) {
    for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (holds(mesh_.triangles[t], simplex_)) continue;
      const double a = height(t, g_);
      const double b = height(t, next);
      const double rounding = 1e-12 * (g_.norm() + next.norm());  // of this check's own arithmetic
      if (!(a > rounding && b < -rounding)) continue;
      const Vec3 x = g_ + a / (a - b) * (next - g_);
      bool in = true;
      for (std::size_t e = 0; e < 3; ++e) in = in && inside(t, e, x) > rounding;
      crossed_ = crossed_ || in;
    }
  }

  const surface::TriangleMesh& mesh_;
  std::vector<Vec3> normals_;
  Vec3 g_ = Vec3::Zero();
  std::set<Index> simplex_;  // the corners of the face, edge or vertex that holds the god-object; empty when free
  bool failed_ = false;
  bool crossed_ = false;
};

}  // namespace touchstone::renderers
