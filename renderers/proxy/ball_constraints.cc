#include "renderers/proxy/ball_constraints.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderers/friction/fixed_order.h"
#include "renderers/friction/nearest_in_polyhedron.h"
#include "renderers/mesh_traversal/counted_contact_mesh.h"

namespace touchstone::renderers {
using surface::Feature;

namespace {

constexpr int newton_steps = 16;
constexpr int feature_changes = 6;
// Of rounding: what may be left of a gap where the answer no longer moves, or goes round between places below rounding
// apart. Of normals nearly alike (cos 0.9999) the equations of the multipliers lose four digits, and with them the
// place.
constexpr double standing = 64.0;
// Of the last move: one that is no shorter than this gains nothing, or too little for the steps that are left.
constexpr double gaining = 0.4;
// Of rounding: moves between planes that stay longer than that do not become shorter.
constexpr double noise_ulps = 16.0;
// Of two unit normals: planes that differ by less meet in a crease that costs the multipliers' equations six digits.
constexpr double nearly_flat_sine = 1e-3;
// For what is farther for sure, rounding aside.
constexpr double beyond_factor = 1.0 + 64.0 * std::numeric_limits<double>::epsilon();
// Noise goes round among that many places at most, nearly always: 223 of 235 runs that did not settle.
constexpr int circle = 4;
constexpr int cuts = 40;  // of the search for the least distance along a way

// On one triangle: by its face, edge or corner in closed form, until the answer's own closest feature is the one used.
// Both this and newton() answer false where the contact ends up on the triangle's other side.
template <class Mesh, class S = typename Mesh::Scalar>
bool rest_on_one(const Mesh& mesh, std::int32_t triangle, const S& r, const Vec3Of<S>& p, Vec3Of<S>& x) noexcept {
  using V = Vec3Of<S>;
  const S none(0.0);
  const FacetOf<S>& facet = mesh.facet(triangle);
  TouchOf<S> now = touch(mesh, triangle, x);
  const V before = now.n;
  for (int change = 0; change < feature_changes; ++change) {
    V next;
    S pull(0.0);
    if (now.feature == Feature::face) {
      const V& n = now.n;
      pull = r - dot(n, p - facet.origin);
      next = p + pull * n;
    } else {
      V foot = mesh.vertex(facet.corner[now.index]);
      if (now.feature == Feature::edge) {
        const V along = mesh.vertex(facet.corner[(now.index + 1U) % 3U]) - foot;
        foot += dot(along, p - foot) / squared_norm(along) * along;
      }
      const V out = p - foot;
      const S distance = norm(out);
      // Beyond the edge or corner the nearest place is on its other side: the ball must find its way round it first.
      if (!(dot(out, now.n) > none)) return false;
      pull = r - distance;
      next = foot + (r / distance) * out;
    }
    if (pull < none) return false;
    const TouchOf<S> then = touch(mesh, triangle, next);
    x = next;
    if (then.feature == now.feature && then.index == now.index) return dot(then.n, before) > none;
    now = then;
  }
  return false;
}

template <class S>
using Mat3Of = Eigen::Matrix<S, 3, 3>;

// The second derivative of the distance from an edge or corner.
template <class Mesh, class S = typename Mesh::Scalar>
Mat3Of<S> curvature(const Mesh& mesh, std::int32_t triangle, const TouchOf<S>& t) noexcept {
  Mat3Of<S> bend = Mat3Of<S>::Identity() - t.n * t.n.transpose();
  if (t.feature == Feature::edge) {
    const auto& corner = mesh.facet(triangle).corner;
    const Vec3Of<S> e = unit(mesh.vertex(corner[(t.index + 1U) % 3U]) - mesh.vertex(corner[t.index]));
    bend -= e * e.transpose();
  }
  return bend / t.d;
}

// Whether two triangles, and no third, hold the ball in such a crease.
template <class Mesh, class S = typename Mesh::Scalar>
bool nearly_flat(const Mesh& mesh, const Holding& holding) noexcept {
  if (holding.size != 2) return false;
  const Vec3Of<S>& a = mesh.facet(holding.triangle[0]).n;
  const Vec3Of<S>& b = mesh.facet(holding.triangle[1]).n;
  return squared_distance<S>(a, b) < nearly_flat_sine * nearly_flat_sine;
}

enum class Found : std::uint8_t { rest, nothing, unsettled };

template <int M, class Mesh, class S = typename Mesh::Scalar>
Found newton(const Mesh& mesh, const Holding& holding, const S& r, const Vec3Of<S>& p, const S& rounding,
             Vec3Of<S>& x) noexcept {
  using std::abs;
  using Multipliers = Eigen::Matrix<S, M, 1>;
  using Normals = Eigen::Matrix<S, 3, M>;
  const S none(0.0);
  Multipliers l = Multipliers::Zero();
  Normals before;  // the normals at the start
  S last_length(std::numeric_limits<double>::infinity());
  bool was_slow = false;
  bool were_planes = false;
  std::array<Vec3Of<S>, circle> places;  // after the last steps, and the multipliers of each
  std::array<Multipliers, circle> pressed;
  for (int step = 0; step < newton_steps; ++step) {
    Normals n;
    Multipliers gap;
    Mat3Of<S> k = Mat3Of<S>::Identity();
    bool bent = false;
    bool edges = false;
    for (int i = 0; i < M; ++i) {
      const std::int32_t triangle = holding.triangle[static_cast<std::size_t>(i)];
      const TouchOf<S> t = touch(mesh, triangle, x);
      n.col(i) = t.n;
      gap[i] = r - t.d;
      edges = edges || t.feature != Feature::face;
      if (step > 0 && t.feature != Feature::face && t.d > none) {
        k -= l[i] * curvature(mesh, triangle, t);
        bent = true;
      }
    }
    if (step == 0) before = n;
    // K dx - N l = p - x, N' dx = gap: eliminate dx. Of planes K is the identity.
    Mat3Of<S> inverse;
    if (bent && !invert<S>(k, 1e-12, inverse)) return Found::nothing;
    const Normals released_n = bent ? product(inverse, n) : n;
    const Eigen::Matrix<S, M, M> gram = inner_products(n, released_n);
    Eigen::Matrix<S, M, M> gram_inverse;
    if (!invert<S>(gram, 1e-24, gram_inverse)) return Found::nothing;
    const Vec3Of<S> pull = p - x;
    const Vec3Of<S> released_pull = bent ? product(inverse, pull) : pull;
    const Multipliers left = gap - inner_products(n, released_pull);
    l = product(gram_inverse, left);
    const Vec3Of<S> pushed = pull + product(n, l);
    const Vec3Of<S> dx = bent ? product(inverse, pushed) : pushed;
    if (!finite(dx)) return Found::nothing;
    // Far steps leave the neighbourhood in which the closest features are what they are.
    const S length = norm(dx);
    const bool far = length > S(0.5) * r;
    const auto holds = [&] {
      for (int i = 0; i < M; ++i) {
        if (!(l[i] >= none && dot(n.col(i), before.col(i)) > none)) return false;
      }
      return true;
    };
    const auto closed = [&](const S& open) {
      bool all = true;
      for (int i = 0; i < M; ++i) all = all && abs(gap[i]) <= open;
      return all;
    };
    // What will not settle in the steps that are left, in a nearly flat crease. Planes meet after one step, but for
    // rounding, which the angle between them magnifies. Where an edge lies in the plane of the other triangle the two
    // are tangential to each other: each move is half of the last.
    const bool slow = !far && length >= S(gaining) * last_length;
    const bool planes_again = were_planes && !edges && !far;
    const bool noise = planes_again && length > S(noise_ulps) * rounding;
    const bool late = slow && was_slow && length > S(std::ldexp(1.0, newton_steps - step)) * rounding;
    if ((noise || late) && nearly_flat(mesh, holding)) return Found::unsettled;
    were_planes = !edges && !far;
    was_slow = slow;
    last_length = length;
    const Vec3Of<S> next = x + (far ? Vec3Of<S>(S(0.5) * r / length * dx) : dx);
    const bool stands = next == x;
    x = next;
    // A place and its multipliers are all that the next step depends on: what comes back to them goes round for ever.
    bool circles = false;
    for (int i = std::max(0, step - circle); i < step && slow && !circles; ++i) {
      const auto at = static_cast<std::size_t>(i % circle);
      circles = places[at] == x && pressed[at] == l;
    }
    // The last normals are those at x but for a step of rounding.
    const bool ends = stands || circles || (planes_again && slow);
    if (!far && length <= (planes_again && slow ? S(standing * rounding) : rounding) &&
        closed(ends ? S(standing * rounding) : rounding))
      return holds() ? Found::rest : Found::nothing;
    if (circles || (stands && !far && length <= rounding)) return Found::unsettled;
    places[static_cast<std::size_t>(step % circle)] = x;
    pressed[static_cast<std::size_t>(step % circle)] = l;
  }
  return Found::unsettled;
}

// In a nearly flat crease, on the planes of its two triangles: in closed form and by orthonormal directions
// (nearest_in_polyhedron.h), which lose half of the digits that the multipliers' equations lose. It is the answer where
// the ball is as far from each triangle itself.
template <class Mesh, class S = typename Mesh::Scalar>
bool rest_in_crease(const Mesh& mesh, const Holding& holding, const S& r, const Vec3Of<S>& p, const S& rounding,
                    Vec3Of<S>& x) noexcept {
  using std::abs;
  std::array<HalfSpaceOf<S>, 2> planes;
  for (std::size_t i = 0; i < 2; ++i) {
    const FacetOf<S>& facet = mesh.facet(holding.triangle[i]);
    const S height = facet.height(x);
    const bool front = height >= S(0.0);
    planes[i] = {front ? facet.n : Vec3Of<S>(-facet.n), r - abs(height)};
  }
  Vec3Of<S> way;
  if (!nearest_on_planes<S>(planes, p - x, way)) return false;
  const Vec3Of<S> there = x + way;
  for (std::size_t i = 0; i < 2; ++i) {
    const TouchOf<S> t = touch(mesh, holding.triangle[i], there);
    if (!(abs(t.d - r) <= rounding && dot(t.n, planes[i].n) > S(0.0))) return false;
  }
  x = there;
  return true;
}

template <int M, class Mesh, class S = typename Mesh::Scalar>
bool rest_on_several(const Mesh& mesh, const Holding& holding, const S& r, const Vec3Of<S>& p, const S& rounding,
                     Vec3Of<S>& x) noexcept {
  const Vec3Of<S> start = x;
  const Found found = newton<M>(mesh, holding, r, p, rounding, x);
  if (found != Found::unsettled || !nearly_flat(mesh, holding)) return found == Found::rest;
  x = start;
  return rest_in_crease(mesh, holding, r, p, rounding, x);
}

}  // namespace

template <class Mesh, class S>
TouchOf<S> touch(const Mesh& mesh, std::int32_t triangle, const Vec3Of<S>& x) noexcept {
  using std::abs;
  using std::sqrt;
  using V = Vec3Of<S>;
  const S none(0.0);
  const FacetOf<S>& facet = mesh.facet(triangle);
  const S h = facet.height(x);
  const std::array<S, 3> s{facet.inside(0, x), facet.inside(1, x), facet.inside(2, x)};
  if (s[0] >= none && s[1] >= none && s[2] >= none)
    return {h >= none ? facet.n : V(-facet.n), abs(h), Feature::face, 0};
  // The closest point is on an edge that x is outside of, or at one of its ends.
  TouchOf<S> best{facet.n, none, Feature::vertex, 0};
  V from = V::Zero();
  S least(std::numeric_limits<double>::infinity());
  for (std::uint8_t e = 0; e < 3; ++e) {
    if (s[e] >= none) continue;
    const auto next = static_cast<std::uint8_t>(e == 2 ? 0 : e + 1);
    const V& start = mesh.vertex(facet.corner[e]);
    const V along = mesh.vertex(facet.corner[next]) - start;
    const V out = x - start;
    const S reach = dot(out, along);
    V here;
    Feature feature = Feature::vertex;
    std::uint8_t index = e;
    if (reach <= none) {
      here = out;
    } else if (reach >= squared_norm(along)) {
      here = out - along;
      index = next;
    } else {
      here = h * facet.n + s[e] * facet.inward[e];
      feature = Feature::edge;
    }
    if (const S squared = squared_norm(here); squared < least) {
      least = squared;
      from = here;
      best.feature = feature;
      best.index = index;
    }
  }
  best.d = sqrt(least);
  if (best.d > none) best.n = from / best.d;
  return best;
}

template <class Mesh, class S>
bool comes_within(const Mesh& mesh, std::int32_t triangle, const Vec3Of<S>& x, const S& reach) noexcept {
  using std::abs;
  const FacetOf<S>& facet = mesh.facet(triangle);
  const Vec3Of<S> from = x - facet.origin;
  const S height = dot(facet.n, from);
  if (abs(height) > reach) return false;
  // Nearly always its first corner or its plane and borders say it.
  if (squared_norm(from) <= reach * reach) return true;
  const S outside = -std::min(std::min(dot(facet.inward[0], from), dot(facet.inward[1], from) - facet.inset),
                              dot(facet.inward[2], from));
  if (outside <= S(0.0)) return true;
  if (height * height + outside * outside > beyond_factor * reach * reach) return false;
  return touch(mesh, triangle, x).d <= reach;
}

template <class Mesh, class S>
bool surely_beyond(const Mesh& mesh, std::int32_t triangle, const Vec3Of<S>& x, const S& reach) noexcept {
  const FacetOf<S>& facet = mesh.facet(triangle);
  const S height = facet.height(x);
  if (height >= reach) return true;
  const S outside = -std::min(std::min(facet.inside(0, x), facet.inside(1, x)), facet.inside(2, x));
  return outside > S(0.0) && height * height + outside * outside > beyond_factor * reach * reach;
}

// The distance from a convex set is convex along the way: between two points it lies above the tangents there, and they
// bracket its least value.
template <class Mesh, class S>
bool stays_clear(const Mesh& mesh, std::int32_t triangle, const Vec3Of<S>& a, const Vec3Of<S>& b,
                 const S& distance) noexcept {
  const Vec3Of<S> way = b - a;
  struct At {
    S t, d, slope;
  };
  const auto place = [&](S t) {
    const TouchOf<S> here = touch(mesh, triangle, Vec3Of<S>(a + t * way));
    return At{t, here.d, dot(here.n, way)};
  };
  At low = place(0.0);
  At high = place(1.0);
  if (low.d < distance || high.d < distance) return false;
  for (int i = 0; i < cuts; ++i) {
    if (low.slope >= S(0.0) || high.slope <= S(0.0)) return true;
    // Where the tangents meet.
    const S t = (high.d - low.d + low.slope * low.t - high.slope * high.t) / (low.slope - high.slope);
    if (low.d + low.slope * (t - low.t) >= distance) return true;
    const At between = place(std::clamp(t, low.t, high.t));
    if (between.d < distance) return false;
    (between.slope < S(0.0) ? low : high) = between;
  }
  return false;
}

template <class Mesh, class S>
bool rest_on(const Mesh& mesh, const Holding& holding, const S& r, const Vec3Of<S>& p, const S& rounding,
             Vec3Of<S>& x) noexcept {
  if (holding.size == 0) {
    x = p;
    return true;
  }
  if (holding.size == 1) return rest_on_one(mesh, holding.triangle[0], r, p, x);
  return holding.size == 2 ? rest_on_several<2>(mesh, holding, r, p, rounding, x)
                           : rest_on_several<3>(mesh, holding, r, p, rounding, x);
}

template <class Mesh, class S>
Vec3Of<S> way_round(const Mesh& mesh, const Holding& holding, const S& r, const Vec3Of<S>& x, const Vec3Of<S>& p,
                    const S& rounding) noexcept {
  if (holding.size == 0) return p;
  const std::int32_t triangle = holding.triangle[0];
  const TouchOf<S> t = touch(mesh, triangle, x);
  // The triangles at the edge or corner, and no other.
  for (int i = 0; i < holding.size; ++i) {
    const TouchOf<S> other = touch(mesh, holding.triangle[static_cast<std::size_t>(i)], x);
    if (other.feature == Feature::face || distance<S>(other.n, t.n) * r > standing * rounding) return p;
  }
  const FacetOf<S>& facet = mesh.facet(triangle);
  Vec3Of<S> foot = mesh.vertex(facet.corner[t.index]);
  if (t.feature == Feature::edge) {
    const Vec3Of<S> along = mesh.vertex(facet.corner[(t.index + 1U) % 3U]) - foot;
    foot += dot(along, p - foot) / squared_norm(along) * along;
  }
  const Vec3Of<S> out = p - foot;
  const S away = norm(out);
  if (!(away > rounding && away < r)) return p;
  return foot + (r / away) * out;
}

template TouchOf<double> touch(const ContactMesh&, std::int32_t, const Vec3&) noexcept;
template TouchOf<Counted> touch(const CountedContactMesh&, std::int32_t, const Vec3Of<Counted>&) noexcept;
template bool comes_within(const ContactMesh&, std::int32_t, const Vec3&, const double&) noexcept;
template bool comes_within(const CountedContactMesh&, std::int32_t, const Vec3Of<Counted>&, const Counted&) noexcept;
template bool surely_beyond(const ContactMesh&, std::int32_t, const Vec3&, const double&) noexcept;
template bool surely_beyond(const CountedContactMesh&, std::int32_t, const Vec3Of<Counted>&, const Counted&) noexcept;
template bool stays_clear(const ContactMesh&, std::int32_t, const Vec3&, const Vec3&, const double&) noexcept;
template bool stays_clear(const CountedContactMesh&, std::int32_t, const Vec3Of<Counted>&, const Vec3Of<Counted>&,
                          const Counted&) noexcept;
template Vec3 way_round(const ContactMesh&, const Holding&, const double&, const Vec3&, const Vec3&,
                        const double&) noexcept;
template Vec3Of<Counted> way_round(const CountedContactMesh&, const Holding&, const Counted&, const Vec3Of<Counted>&,
                                   const Vec3Of<Counted>&, const Counted&) noexcept;
template bool rest_on(const ContactMesh&, const Holding&, const double&, const Vec3&, const double&, Vec3&) noexcept;
template bool rest_on(const CountedContactMesh&, const Holding&, const Counted&, const Vec3Of<Counted>&, const Counted&,
                      Vec3Of<Counted>&) noexcept;

}  // namespace touchstone::renderers
