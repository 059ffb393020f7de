#include "renderers/surface_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "renderers/front_crossing.h"

namespace touchstone {
namespace {

// Where an edge lies: its two triangles with the tip's height over and its side of each.
struct EdgeView {
  std::int32_t other;     // the second triangle, or open_edge
  double h1, s1, h2, s2;  // height over the triangle's plane; distance from the edge into its strip
  bool valley;

  // Whether the tip is on the free side: outside both planes of a valley, outside one of a ridge.
  [[nodiscard]] bool free() const noexcept { return valley ? h1 >= 0.0 && h2 >= 0.0 : h1 >= 0.0 || h2 >= 0.0; }
};

EdgeView view_edge(const ContactMesh& mesh, std::int32_t triangle, std::size_t e, const Vec3& p) noexcept {
  const Facet& first = mesh.facet(triangle);
  EdgeView view{first.neighbour[e], first.height(p), first.inside(e, p), 0.0, 0.0, first.valley[e]};
  if (view.other >= 0) {
    const Facet& second = mesh.facet(view.other);
    const std::size_t back = mesh.edge_towards(view.other, triangle, first.corner[(e + 1) % 3]);
    view.h2 = second.height(p);
    view.s2 = second.inside(back, p);
  }
  return view;
}

// Moves without coming closer to the tip before the walk gives up: exact arithmetic needs none at all, rounding a few
// at a vertex. The god-object then rests where it is, which is on the surface.
constexpr int kPatience = 64;

}  // namespace

void SurfaceWalk::start_free(const Vec3& p) noexcept {
  on_ = On::nothing;
  g_ = p;
  push_.setZero();
  transitions_ = 0;
  sliding_ = false;
}

bool SurfaceWalk::start_on(std::int32_t triangle, Feature feature, std::size_t local, const Vec3& p) noexcept {
  const auto [a, b, c] = mesh_->corners(triangle);
  on_ = feature == Feature::vertex ? On::vertex : feature == Feature::edge ? On::edge : On::face;
  triangle_ = triangle;
  local_ = local;
  transitions_ = 0;
  // Where on the feature does not matter: it comes to rest on the closest point.
  g_ = (a + b + c) / 3.0;
  sliding_ = false;
  if (!mesh_->facet(triangle).regular) return false;
  hold_ = 0.0;
  return descend(p);
}

void SurfaceWalk::resume(const Vec3& g, std::int32_t triangle, bool sliding) noexcept {
  on_ = On::face;
  sliding_ = sliding;
  triangle_ = triangle;
  g_ = g;
}

Vec3 SurfaceWalk::normal() const noexcept {
  if (on_ == On::nothing) return Vec3::Zero();
  const Facet& facet = mesh_->facet(triangle_);
  if (on_ == On::face) return facet.n;
  Vec3 across = push_;
  if (on_ == On::edge && !friction_.none()) {
    const Vec3 along = mesh_->vertex(facet.corner[(local_ + 1) % 3]) - mesh_->vertex(facet.corner[local_]);
    across -= along.dot(push_) / along.squaredNorm() * along;
  }
  const double length = across.norm();
  return length > 0.0 ? Vec3(across / length) : facet.n;
}

bool SurfaceWalk::follow(const Vec3& p) noexcept {
  if (friction_.none()) return descend(p);
  hold_ = sliding_ ? friction_.mu_dynamic : friction_.mu_static;
  rounding_ = resting_error(*mesh_, p);
  sliding_ = false;
  return descend(p);
}

double SurfaceWalk::slip(double depth_m) noexcept {
  sliding_ = true;
  hold_ = friction_.mu_dynamic;
  return hold_ * depth_m;
}

bool SurfaceWalk::descend(const Vec3& p) noexcept {
  double least = std::numeric_limits<double>::infinity();
  int patience = kPatience;
  stopped_ = false;
  while (true) {
    bool done = false;
    switch (on_) {
      case On::nothing:
        done = leave(p);
        break;
      case On::face:
        done = slide_on_face(p);
        break;
      case On::edge:
        done = slide_on_edge(p);
        break;
      case On::vertex:
        done = turn_at_vertex(p);
        break;
    }
    if (done) return !stopped_;
    ++transitions_;
    const double left = (p - g_).squaredNorm();
    patience = left < least ? kPatience : patience - 1;
    least = std::min(least, left);
    if (patience == 0) {
      // Along a rim to rounding it can be neither on the sheet nor past it: then it is past it.
      if (!mesh_->closed() && near_rim()) {
        on_ = On::nothing;
        g_ = p;
      }
      push_ = g_ - p;
      return true;
    }
  }
}

bool SurfaceWalk::slide_on_face(const Vec3& p) noexcept {
  const Facet& facet = mesh_->facet(triangle_);
  Vec3 r = p - facet.origin;
  const double h = facet.n.dot(r);
  if (h >= 0.0) return leave(p);
  Vec3 push = -h * facet.n;
  if (hold_ > 0.0) {
    Vec3 behind = g_ - (p + push);
    const double away = behind.norm();
    if (held(away, -h)) return rest(g_, push + behind);
    behind *= slip(-h) / away;
    r += behind;
    push += behind;
  }
  const std::array<double, 3> s{facet.inward[0].dot(r), facet.inward[1].dot(r) - facet.inset, facet.inward[2].dot(r)};
  if (s[0] >= 0.0 && s[1] >= 0.0 && s[2] >= 0.0) return rest(p + push, push);

  // Over the border that the straight way within the plane meets first.
  const Vec3 goal = p + push;
  double first = 2.0;
  std::size_t exit = 0;
  std::size_t tied = 3;
  for (std::size_t e = 0; e < 3; ++e) {
    if (s[e] >= 0.0) continue;
    const double here = std::max(0.0, facet.inside(e, g_));
    const double fraction = here / (here - s[e]);
    if (fraction < first) {
      first = fraction;
      exit = e;
      tied = 3;
    } else if (fraction == first) {
      tied = e;
    }
  }
  if (tied < 3) return to_vertex(triangle_, (exit + 1) % 3 == tied ? tied : exit);
  const Vec3& from = mesh_->vertex(facet.corner[exit]);
  const Vec3 along = mesh_->vertex(facet.corner[(exit + 1) % 3]) - from;
  const double u = (g_ + first * (goal - g_) - from).dot(along) / along.squaredNorm();
  if (u <= 0.0) return to_vertex(triangle_, exit);
  if (u >= 1.0) return to_vertex(triangle_, (exit + 1) % 3);
  g_ = from + u * along;
  on_ = On::edge;
  local_ = exit;
  return false;
}

bool SurfaceWalk::slide_on_edge(const Vec3& p) noexcept {
  const EdgeView edge = view_edge(*mesh_, triangle_, local_, p);
  if (edge.other < 0) return edge.h1 < 0.0 && edge.s1 > 0.0 ? to_face(triangle_) : leave(p);
  if (edge.free()) return leave(p);
  // Into a face's strip. Of a valley the strips are disjoint; from a ridge both may lead down: the steeper one.
  const bool first = edge.h1 < 0.0 && edge.s1 > 0.0;
  const bool second = edge.h2 < 0.0 && edge.s2 > 0.0;
  if (first && (!second || edge.s1 >= edge.s2)) return to_face(triangle_);
  if (second) return to_face(edge.other);
  const Facet& facet = mesh_->facet(triangle_);
  std::size_t start = local_;
  std::size_t end = (local_ + 1) % 3;
  // From the smaller index: the answer does not depend on the triangle from which the edge was reached.
  if (facet.corner[start] > facet.corner[end]) std::swap(start, end);
  const Vec3& from = mesh_->vertex(facet.corner[start]);
  const Vec3& to = mesh_->vertex(facet.corner[end]);
  const Vec3 along = to - from;
  // Asked from both ends as turn_at_vertex() does, so that the two never disagree.
  const double after = (p - from).dot(along);
  const double before = (p - to).dot(-along);
  if (hold_ > 0.0) {
    const double length = along.norm();
    const double foot = after / (after + before);
    const double depth = (p - (from + foot * along)).norm();
    const double behind = (g_ - from).dot(along) / (length * length) - foot;
    if (held(std::abs(behind) * length, depth)) return rest(g_, g_ - p);
    const double there = foot + std::copysign(slip(depth) / length, behind);
    if (there <= 0.0) return to_vertex(triangle_, start);
    if (there >= 1.0) return to_vertex(triangle_, end);
    const Vec3 g = from + there * along;
    return rest(g, g - p);
  }
  if (after <= 0.0) return to_vertex(triangle_, start);
  if (before <= 0.0) return to_vertex(triangle_, end);
  const Vec3 g = from + after / (after + before) * along;
  return rest(g, g - p);
}

bool SurfaceWalk::turn_at_vertex(const Vec3& p) noexcept {
  const std::int32_t index = mesh_->facet(triangle_).corner[local_];
  const Vec3& v = mesh_->vertex(index);
  const Vec3 d = p - v;
  // The way down the steepest: the point of the faces' and edges' infinite cone that is closest to the tip. On which
  // side of the cone the tip is follows from there (Baerentzen and Aanaes 2005, theorem 1).
  double steepest = 0.0;
  std::int32_t triangle = -1;
  std::size_t corner = 0;
  bool into_face = false;
  double height = 0.0;
  for (const std::int32_t t : mesh_->fan(index)) {
    const Facet& facet = mesh_->facet(t);
    const std::size_t c = facet.corner[0] == index ? 0 : facet.corner[1] == index ? 1 : 2;
    if (facet.inside(c, p) >= 0.0 && facet.inside((c + 2) % 3, p) >= 0.0) {
      const double h = facet.height(p);
      const double rate = (d - h * facet.n).squaredNorm();
      if (rate > steepest) {
        steepest = rate;
        triangle = t;
        corner = c;
        into_face = true;
        height = h;
      }
    }
    const Vec3 along = mesh_->vertex(facet.corner[(c + 1) % 3]) - v;
    const double reach = d.dot(along);
    if (reach > 0.0 && facet.neighbour[c] >= 0) {
      const double rate = reach * reach / along.squaredNorm();
      if (rate > steepest) {
        steepest = rate;
        triangle = t;
        corner = c;
        into_face = false;
      }
    }
  }
  if (triangle < 0) {
    if (mesh_->open_vertex(index) || mesh_->vertex_normal(index).dot(d) > 0.0 || d.isZero(0.0)) return leave(p);
    return rest(v, -d);
  }
  if (into_face) return height >= 0.0 ? leave(p) : to_face(triangle);
  if (view_edge(*mesh_, triangle, corner, p).free()) return leave(p);
  triangle_ = triangle;
  local_ = corner;
  on_ = On::edge;
  return false;
}

bool SurfaceWalk::leave(const Vec3& p) noexcept {
  const FrontCrossing hit = first_front_crossing(*mesh_, g_, p, [this](std::int32_t t) { return touches(t); });
  if (hit.triangle < 0) {
    on_ = On::nothing;
    g_ = p;
    push_.setZero();
    return true;
  }
  g_ += hit.fraction * (p - g_);
  return to_face(hit.triangle);
}

bool SurfaceWalk::touches(std::int32_t triangle) const noexcept {
  switch (on_) {
    case On::nothing:
      return false;
    case On::face:
      return triangle == triangle_;
    case On::edge:
      return triangle == triangle_ || triangle == mesh_->facet(triangle_).neighbour[local_];
    case On::vertex:
      break;
  }
  const std::int32_t index = mesh_->facet(triangle_).corner[local_];
  const auto& corner = mesh_->facet(triangle).corner;
  return corner[0] == index || corner[1] == index || corner[2] == index;
}

bool SurfaceWalk::near_rim() const noexcept {
  const auto& corner = mesh_->facet(triangle_).corner;
  return std::any_of(corner.begin(), corner.end(), [this](std::int32_t v) { return mesh_->open_vertex(v); });
}

bool SurfaceWalk::to_face(std::int32_t triangle) noexcept {
  on_ = On::face;
  triangle_ = triangle;
  stopped_ = !mesh_->facet(triangle).regular;
  return stopped_;
}

bool SurfaceWalk::to_vertex(std::int32_t triangle, std::size_t corner) noexcept {
  on_ = On::vertex;
  triangle_ = triangle;
  local_ = corner;
  g_ = mesh_->vertex(mesh_->facet(triangle).corner[corner]);
  return false;
}

bool SurfaceWalk::rest(const Vec3& g, const Vec3& push) noexcept {
  g_ = g;
  push_ = push;
  return true;
}

}  // namespace touchstone
