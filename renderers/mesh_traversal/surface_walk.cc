#include "renderers/mesh_traversal/surface_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "renderers/mesh_traversal/counted_contact_mesh.h"
#include "renderers/mesh_traversal/fetch.h"
#include "renderers/mesh_traversal/front_crossing.h"

namespace touchstone::renderers {
using surface::Feature;

namespace {

// Where an edge lies: its two triangles with the tip's height over and its side of each.
template <class S>
struct EdgeView {
  std::int32_t other;  // the second triangle, or open_edge
  S h1, s1, h2, s2;    // height over the triangle's plane; distance from the edge into its strip
  bool valley;

  // Whether the tip is on the free side: outside both planes of a valley, outside one of a ridge.
  [[nodiscard]] bool free() const noexcept {
    return valley ? h1 >= S(0.0) && h2 >= S(0.0) : h1 >= S(0.0) || h2 >= S(0.0);
  }
};

template <class Mesh, class S = typename Mesh::Scalar>
EdgeView<S> view_edge(const Mesh& mesh, std::int32_t triangle, std::size_t e, const Vec3Of<S>& p) noexcept {
  const FacetOf<S>& first = mesh.facet(triangle);
  EdgeView<S> view{first.neighbour[e], first.height(p), first.inside(e, p), S(0.0), S(0.0), first.valley[e]};
  if (view.other >= 0) {
    const FacetOf<S>& second = mesh.facet(view.other);
    const std::size_t back = mesh.edge_towards(view.other, triangle, first.corner[(e + 1) % 3]);
    view.h2 = second.height(p);
    view.s2 = second.inside(back, p);
  }
  return view;
}

// What the two walls of a valley press on a god-object that rests on its edge, added: l_1 + l_2 in its distance from
// the tip l_1 n_1 + l_2 n_2, whose parts along the normals are the tip's depths (cone_friction.h). A ridge holds
// nothing.
template <class S>
S pressed_on_edge(const EdgeView<S>& edge, const Vec3Of<S>& n1, const Vec3Of<S>& n2, const S& distance_m) noexcept {
  const S both = S(1.0) + dot(n1, n2);
  return edge.valley && both > S(0.0) ? S(-(edge.h1 + edge.h2) / both) : distance_m;
}

// Moves without coming closer to the tip before the walk gives up: exact arithmetic needs none at all, rounding a few
// at a vertex. The god-object then rests where it is, which is on the surface.
constexpr int most_rounds = 64;

}  // namespace

template <class Mesh>
void SurfaceWalkOf<Mesh>::start_free(const V& p) noexcept {
  on_ = On::nothing;
  g_ = p;
  push_.setZero();
  transitions_ = 0;
  sliding_ = false;
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::start_on(std::int32_t triangle, Feature feature, std::size_t local, const V& p) noexcept {
  const auto [a, b, c] = mesh_->corners(triangle);
  on_ = feature == Feature::vertex ? On::vertex : feature == Feature::edge ? On::edge : On::face;
  triangle_ = triangle;
  local_ = local;
  transitions_ = 0;
  // Where on the feature does not matter: it comes to rest on the closest point.
  g_ = (a + b + c) / S(3.0);
  sliding_ = false;
  if (!mesh_->facet(triangle).regular) return false;
  hold_ = zero;
  return descend(p);
}

template <class Mesh>
void SurfaceWalkOf<Mesh>::resume(const V& g, std::int32_t triangle, bool sliding) noexcept {
  on_ = On::face;
  sliding_ = sliding;
  triangle_ = triangle;
  g_ = g;
}

template <class Mesh>
auto SurfaceWalkOf<Mesh>::normal() const noexcept -> V {
  if (on_ == On::nothing) return V(V::Zero());
  const FacetOf<S>& facet = mesh_->facet(triangle_);
  if (on_ == On::face) return facet.n;
  V across = push_;
  if (on_ == On::edge && !friction_.none()) {
    const V along = mesh_->vertex(facet.corner[(local_ + 1) % 3]) - mesh_->vertex(facet.corner[local_]);
    across -= dot(along, push_) / squared_norm(along) * along;
  }
  const S length = sqrt(squared_norm(across));
  return length > zero ? V(across / length) : facet.n;
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::follow(const V& p) noexcept {
  if (friction_.none()) return descend(p);
  const bool was_sliding = sliding_;
  hold_ = S(was_sliding ? friction_.mu_dynamic : friction_.mu_static);
  rounding_ = resting_error(*mesh_, p);
  sliding_ = false;
  const bool done = descend(p);
  // Stopped on the way: what goes on from here goes on sliding.
  if (!done) sliding_ = sliding_ || was_sliding;
  return done;
}

template <class Mesh>
auto SurfaceWalkOf<Mesh>::slip(S depth_m) noexcept -> S {
  sliding_ = true;
  hold_ = S(friction_.mu_dynamic);
  return hold_ * depth_m;
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::descend(const V& p) noexcept {
  S least = S(std::numeric_limits<double>::infinity());
  int patience = most_rounds;
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
    const S left = squared_norm(p - g_);
    patience = left < least ? most_rounds : patience - 1;
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

template <class Mesh>
bool SurfaceWalkOf<Mesh>::slide_on_face(const V& p) noexcept {
  const FacetOf<S>& facet = mesh_->facet(triangle_);
  V r = p - facet.origin;
  const S h = dot(facet.n, r);
  if (h >= zero) return leave(p);
  V push = -h * facet.n;
  if (hold_ > zero) {
    V behind = g_ - (p + push);
    const S away = sqrt(squared_norm(behind));
    if (held(away, -h)) return rest(g_, push + behind);
    behind *= slip(-h) / away;
    r += behind;
    push += behind;
  }
  const std::array<S, 3> s{dot(facet.inward[0], r), dot(facet.inward[1], r) - facet.inset, dot(facet.inward[2], r)};
  if (s[0] >= zero && s[1] >= zero && s[2] >= zero) return rest(p + push, push);

  // Over the border that the straight way within the plane meets first.
  const V goal = p + push;
  S first(2.0);
  std::size_t exit = 0;
  std::size_t tied = 3;
  for (std::size_t e = 0; e < 3; ++e) {
    if (s[e] >= zero) continue;
    const S here = std::max(zero, facet.inside(e, g_));
    const S fraction = here / (here - s[e]);
    if (fraction < first) {
      first = fraction;
      exit = e;
      tied = 3;
    } else if (fraction == first) {
      tied = e;
    }
  }
  if (tied < 3) return to_vertex(triangle_, (exit + 1) % 3 == tied ? tied : exit);
  const V& from = mesh_->vertex(facet.corner[exit]);
  const V along = mesh_->vertex(facet.corner[(exit + 1) % 3]) - from;
  const S u = dot(g_ + first * (goal - g_) - from, along) / squared_norm(along);
  if (u <= zero) return to_vertex(triangle_, exit);
  if (u >= one) return to_vertex(triangle_, (exit + 1) % 3);
  g_ = from + u * along;
  on_ = On::edge;
  local_ = exit;
  return false;
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::slide_on_edge(const V& p) noexcept {
  const EdgeView<S> edge = view_edge(*mesh_, triangle_, local_, p);
  if (edge.other < 0) return edge.h1 < zero && edge.s1 > zero ? to_face(triangle_) : leave(p);
  if (edge.free()) return leave(p);
  // Into a face's strip. Of a valley the strips are disjoint; from a ridge both may lead down: the steeper one.
  const bool under_first = edge.h1 < zero;
  const bool first = under_first && edge.s1 > zero;
  const bool under_second = edge.h2 < zero;
  const bool second = under_second && edge.s2 > zero;
  if (first && (!second || edge.s1 >= edge.s2)) return to_face(triangle_);
  if (second) return to_face(edge.other);
  // In front of a face, in its strip. In a valley that is behind the other face's plane only where the two planes are
  // one to rounding, with the tip in them: what is in front of a face is free.
  if ((!under_first && edge.s1 > zero) || (!under_second && edge.s2 > zero)) return leave(p);
  const FacetOf<S>& facet = mesh_->facet(triangle_);
  std::size_t start = local_;
  std::size_t end = (local_ + 1) % 3;
  // From the smaller index: the answer does not depend on the triangle from which the edge was reached.
  if (facet.corner[start] > facet.corner[end]) std::swap(start, end);
  const V& from = mesh_->vertex(facet.corner[start]);
  const V& to = mesh_->vertex(facet.corner[end]);
  const V along = to - from;
  // Asked from both ends as turn_at_vertex() does, so that the two never disagree.
  const S after = dot(p - from, along);
  const S before = dot(p - to, -along);
  if (hold_ > zero) {
    const S length = sqrt(squared_norm(along));
    const S foot = after / (after + before);
    const S pressed =
        pressed_on_edge<S>(edge, facet.n, mesh_->facet(edge.other).n, sqrt(squared_norm(p - (from + foot * along))));
    const S behind = dot(g_ - from, along) / (length * length) - foot;
    if (held(abs(behind) * length, pressed)) return rest(g_, g_ - p);
    const S step = slip(pressed) / length;
    const S there = behind < zero ? S(foot - step) : S(foot + step);
    if (there <= zero) return to_vertex(triangle_, start);
    if (there >= one) return to_vertex(triangle_, end);
    const V g = from + there * along;
    return rest(g, g - p);
  }
  if (after <= zero) return to_vertex(triangle_, start);
  if (before <= zero) return to_vertex(triangle_, end);
  const V g = from + after / (after + before) * along;
  return rest(g, g - p);
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::turn_at_vertex(const V& p) noexcept {
  const std::int32_t index = mesh_->facet(triangle_).corner[local_];
  const V& v = mesh_->vertex(index);
  const V d = p - v;
  // The way down the steepest: the point of the faces' and edges' infinite cone that is closest to the tip. On which
  // side of the cone the tip is follows from there (Baerentzen and Aanaes 2005, theorem 1).
  S steepest(0.0);
  std::int32_t triangle = -1;
  std::size_t corner = 0;
  bool into_face = false;
  S height(0.0);
  for (const std::int32_t t : mesh_->fan(index)) {
    const FacetOf<S>& facet = mesh_->facet(t);
    const std::size_t c = facet.corner[0] == index ? 0 : facet.corner[1] == index ? 1 : 2;
    if (facet.inside(c, p) >= zero && facet.inside((c + 2) % 3, p) >= zero) {
      const S h = facet.height(p);
      const S rate = squared_norm(d - h * facet.n);
      if (rate > steepest) {
        steepest = rate;
        triangle = t;
        corner = c;
        into_face = true;
        height = h;
      }
    }
    const V along = mesh_->vertex(facet.corner[(c + 1) % 3]) - v;
    const S reach = dot(d, along);
    if (reach > zero && facet.neighbour[c] >= 0) {
      const S rate = reach * reach / squared_norm(along);
      if (rate > steepest) {
        steepest = rate;
        triangle = t;
        corner = c;
        into_face = false;
      }
    }
  }
  if (triangle < 0) {
    if (mesh_->open_vertex(index) || dot(mesh_->vertex_normal(index), d) > zero ||
        (d.x() == zero && d.y() == zero && d.z() == zero))
      return leave(p);
    return rest(v, -d);
  }
  if (into_face) return height >= zero ? leave(p) : to_face(triangle);
  if (view_edge(*mesh_, triangle, corner, p).free()) return leave(p);
  triangle_ = triangle;
  local_ = corner;
  on_ = On::edge;
  return false;
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::leave(const V& p) noexcept {
  const FrontCrossingOf<S> hit = first_front_crossing(*mesh_, g_, p, [this](std::int32_t t) { return touches(t); });
  if (hit.triangle < 0) {
    on_ = On::nothing;
    g_ = p;
    push_.setZero();
    return true;
  }
  const V from = g_;
  g_ += hit.fraction * (p - g_);
  if (!to_face(hit.triangle)) return false;
  took_off_ = from;
  flew_ = true;
  return true;
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::touches(std::int32_t triangle) const noexcept {
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

template <class Mesh>
bool SurfaceWalkOf<Mesh>::near_rim() const noexcept {
  const auto& corner = mesh_->facet(triangle_).corner;
  return std::any_of(corner.begin(), corner.end(), [this](std::int32_t v) { return mesh_->open_vertex(v); });
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::to_face(std::int32_t triangle) noexcept {
  on_ = On::face;
  triangle_ = triangle;
  const FacetOf<S>& facet = mesh_->facet(triangle);
  // The next step most likely ends here or on one of these.
  for (const std::int32_t t : facet.neighbour) {
    if (t >= 0) fetch(mesh_->facet(t));
  }
  stopped_ = !facet.regular;
  flew_ = false;
  return stopped_;
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::to_vertex(std::int32_t triangle, std::size_t corner) noexcept {
  on_ = On::vertex;
  triangle_ = triangle;
  local_ = corner;
  g_ = mesh_->vertex(mesh_->facet(triangle).corner[corner]);
  return false;
}

template <class Mesh>
bool SurfaceWalkOf<Mesh>::rest(const V& g, const V& push) noexcept {
  g_ = g;
  push_ = push;
  return true;
}

template class SurfaceWalkOf<ContactMesh>;
template class SurfaceWalkOf<CountedContactMesh>;

}  // namespace touchstone::renderers
