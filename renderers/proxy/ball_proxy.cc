#include "renderers/proxy/ball_proxy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderers/mesh_traversal/counted_contact_mesh.h"
#include "renderers/mesh_traversal/exposed_place.h"
#include "renderers/mesh_traversal/fetch.h"

namespace touchstone::renderers {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
// Triangles to gather at a time: enough for several servo ticks, few enough to test quickly.
constexpr std::size_t few = 16, many = 96, most = 4096;
constexpr std::size_t most_proposed = 2 * most;  // by the tree
constexpr int most_moves = 256;                  // per step; a jump across the object takes some
constexpr int straight = 64;                     // of these, before a way round is looked for
constexpr int most_glides = 8;                   // edges of one move over faces
constexpr int exchanges = 12;                    // of holding triangles per move
constexpr double ahead = 0.7;                    // of the margin: how far ahead of the centre to gather

const ContactMesh& plain_mesh(const ContactMesh& mesh) { return mesh; }
const ContactMesh& plain_mesh(const CountedContactMesh& mesh) { return mesh.plain(); }

}  // namespace

template <class Mesh>
BallProxyOf<Mesh>::BallProxyOf(const Mesh& mesh, const surface::Surface& surface, double radius_m,
                               const ConeFriction& friction)
    : mesh_(&mesh),
      surface_(&surface),
      r_(radius_m),
      cone_(friction),
      probe_walk_(mesh),
      vicinity_(std::in_place, plain_mesh(mesh), radius_m),
      near_(most),
      // Of a ball larger by a margin than one that rests on a plane, a cap of 2 pi r margin lies below the plane.
      most_margin_(static_cast<double>(many / 2) * plain_mesh(mesh).mean_area() / (2.0 * EIGEN_PI * radius_m)),
      next_margin_(std::min(S(0.25 * radius_m), most_margin_)) {
  candidates_.reserve(most_proposed);
  half_spaces_.reserve(most);
  limiting_.reserve(most);
}

template <class Mesh>
void BallProxyOf<Mesh>::start(const V& p) noexcept {
  holding_ = {};
  cone_.stick();
  margin_ = -1.0;
  next_margin_ = std::min(S(0.25 * r_), most_margin_);
  gathers_ = moves_ = 0;
  c_ = p;
  const ContactMesh& plain = plain_mesh(*mesh_);
  const Vec3 tip = p.template cast<double>();
  const surface::SurfacePoint nearest = surface_->closest(tip);
  const StartPlace exposed = start_place(plain, *surface_, tip);
  // Behind the rim of an open mesh there is no inside: the ball passes.
  const bool passes = nearest.signed_distance_m < 0.0 && plain.open();
  const bool clear = nearest.distance_m >= r_;
  if (!exposed.inside && (clear || passes)) return;
  const bool within_bodies = exposed.inside && exposed.triangle != nearest.triangle;
  const std::int32_t triangle = within_bodies ? exposed.triangle : nearest.triangle;
  const Vec3& foot = within_bodies ? exposed.p_W_m : nearest.p_W_m;
  const TouchOf<S> t = touch(*mesh_, triangle, p);
  // On the surface to rounding the direction to the tip is noise.
  rounding_ = rounding_at(p);
  V out = t.n;
  if (within_bodies) {
    out = t.d <= 4.0 * rounding_ ? mesh_->facet(triangle).n : V(-t.n);
  } else if (exposed.inside || t.d <= 4.0 * rounding_) {
    out = nearest.n_W.template cast<S>();
  }
  // Where bodies touch or overlap, the distance alone does not tell free space from another body's inside.
  const bool bodies = !plain.open() && !plain.facet(nearest.triangle).regular;
  // Out until the ball is clear, then down again to where the tip pulls it.
  S reach = r_;
  while (reach < 1e3 * (r_ + mesh_->extent())) {
    c_ = foot.template cast<S>() + reach * out;
    const Vec3 at = c_.template cast<double>();
    if (S(surface_->closest(at).distance_m) >= r_ * (1.0 - 64.0 * eps) && !(bodies && winding_about(plain, at) > 0))
      break;
    reach *= 2.0;
  }
  pull(p);
}

template <class Mesh>
void BallProxyOf<Mesh>::follow(const V& p) noexcept {
  gathered_now_ = false;
  if (cone_.friction().none()) return pull(p);
  cone_.follow(*this, p, std::max(rounding_at(p), rounding_at(c_)));
}

template <class Mesh>
auto BallProxyOf<Mesh>::contact_normals() const noexcept -> ContactNormalsOf<S> {
  ContactNormalsOf<S> contact;
  for (int i = 0; i < holding_.size; ++i) {
    const auto k = static_cast<std::size_t>(i);
    contact.n[k] = touch(*mesh_, holding_.triangle[k], c_).n;
  }
  contact.size = holding_.size;
  return contact;
}

template <class Mesh>
auto BallProxyOf<Mesh>::normal(const V& p) const noexcept -> V {
  if (!touching()) return V(V::Zero());
  if (!cone_.friction().none()) return cone_normal(*this, p, rounding_);
  const V push = c_ - p;
  if (holding_.size > 1 && squared_norm(push) > S(0.0)) return unit(push);
  return touch(*mesh_, holding_.triangle[0], c_).n;
}

template <class Mesh>
auto BallProxyOf<Mesh>::rounding_at(const V& x) const noexcept -> S {
  return 32.0 * eps * std::max(S(mesh_->magnitude()), largest(x));
}

template <class Mesh>
void BallProxyOf<Mesh>::pull(const V& p) noexcept {
  rounding_ = std::max(rounding_at(p), rounding_at(c_));
  for (int move = 0; move < most_moves; ++move) {
    ++moves_;
    Holding holding = holding_;
    V x = c_;
    Check checked;
    if (settle(p, holding, x, checked)) {
      if (advance(x, checked, holding)) return;
    } else if (!constrained_step(move < straight ? p : way_round(*mesh_, holding_, r_, c_, p, rounding_))) {
      return;
    }
  }
}

template <class Mesh>
void BallProxyOf<Mesh>::gather(const V& at, S margin) noexcept {
  ++gathers_;
  gathered_now_ = true;
  while (!gather_within(at, margin) && margin > rounding_) margin *= 0.25;
  gathered_at_ = at;
  margin_ = margin;
  next_margin_ = std::min(margin * (near_.size() > many ? 0.5 : near_.size() < few ? 1.5 : 1.0), most_margin_);
}

// False where there are too many.
template <class Mesh>
bool BallProxyOf<Mesh>::gather_within(const V& at, const S& margin) noexcept {
  const S reach = r_ + margin;
  candidates_.clear();
  bool all = true;
  mesh_->tree().within(at, reach, [&](std::int32_t t) {
    if (candidates_.size() < most_proposed) {
      candidates_.push_back(t);
      fetch(mesh_->facet(t));
    } else {
      all = false;
    }
    return reach;
  });
  // In an order that does not depend on the tree.
  std::sort(candidates_.begin(), candidates_.end());
  const V from_at = c_ - at;
  near_.clear();
  for (const std::int32_t t : candidates_) {
    const FacetOf<S>& facet = mesh_->facet(t);
    if (is_zero(facet.n) || !comes_within(*mesh_, t, at, reach)) continue;
    if (near_.size() == most) return false;
    // Where the surface bends away the triangle's own plane does, now and later: no need of its closest point.
    if (facet.height(c_) >= r_) {
      near_.add(t, facet.n, r_ - facet.height(at));
      continue;
    }
    // Tangential to the triangle from the ball's centre, which is outside; the middle of the gathered may not be.
    const TouchOf<S> here = touch(*mesh_, t, c_);
    near_.add(t, here.n, r_ - here.d + dot(here.n, from_at));
  }
  return all;
}

template <class Mesh>
bool BallProxyOf<Mesh>::ignored(std::int32_t triangle) const noexcept {
  if (mesh_->closed()) return false;
  return mesh_->facet(triangle).height(c_) < -rounding_ || touch(*mesh_, triangle, c_).d < r_ - 64.0 * rounding_;
}

template <class Mesh>
auto BallProxyOf<Mesh>::check(const V& x, const Holding& held) noexcept -> Check {
  know_near();
  Check result;
  const V offset = x - gathered_at_;
  const bool far = squared_distance<S>(x, c_) > 0.25 * r_ * r_;
  S least = r_ - rounding_;
  near_.each_below(offset, S(0.0), [&](std::size_t i) {
    const std::int32_t triangle = near_.triangle(i);
    const FacetOf<S>& facet = mesh_->facet(triangle);
    const S height = facet.height(x);
    const S height_now = facet.height(c_);
    if (height >= r_ && height_now >= r_) {
      near_.set(i, facet.n, r_ - facet.height(gathered_at_));
      return;
    }
    const TouchOf<S> t = touch(*mesh_, triangle, x);
    const bool through = far && height_now >= 0.0 && height < 0.0;
    if (held.has(triangle) || (t.d >= r_ - rounding_ && !through)) {
      // Now tangential at x. The centre, where it is now, must lie in the half-space too for the way to be safe.
      const S b = r_ - t.d + dot(t.n, offset);
      if (dot(t.n, c_ - gathered_at_) >= b - rounding_) {
        near_.set(i, t.n, b - rounding_);
      } else if (far) {
        result.safe_way = result.safe_way && stays_clear(*mesh_, triangle, c_, x, S(r_ - 2.0 * rounding_));
      }
      return;
    }
    if (ignored(triangle)) return;
    const S depth = through ? -t.d : t.d;
    if (depth < least) {
      least = depth;
      result.worst = triangle;
    }
  });
  return result;
}

template <class Mesh>
void BallProxyOf<Mesh>::ask_listed(std::span<const std::int32_t> triangles, const V& x, const Holding& held, S& least,
                                   Check& result) const noexcept {
  for (const std::int32_t triangle : triangles) {
    if (held.has(triangle) || surely_beyond(*mesh_, triangle, x, r_)) continue;
    const S depth = touch(*mesh_, triangle, x).d;
    // Of several that are overlapped as much, the first by index, as check() has them.
    if (!(depth < least || (depth == least && triangle < result.worst)) || ignored(triangle)) continue;
    least = depth;
    result.worst = triangle;
  }
}

template <class Mesh>
auto BallProxyOf<Mesh>::check_face(const V& x, std::int32_t triangle) noexcept -> std::optional<Check> {
  if (!vicinity_ || just_gathered(x)) return std::nullopt;
  const BallVicinity::Of known = vicinity_->of(triangle);
  if (known.spread_m < 0.0) return std::nullopt;
  Check result{.complete = true};
  Holding face;
  face.add(triangle);
  S least = r_ - rounding_;
  ask_listed(known.on_face, x, face, least, result);
  return result;
}

template <class Mesh>
auto BallProxyOf<Mesh>::check_listed(const V& x, const Holding& held) noexcept -> std::optional<Check> {
  using std::abs;
  if (!vicinity_ || just_gathered(x) || held.size == 0 || squared_distance<S>(x, c_) > 0.25 * r_ * r_)
    return std::nullopt;
  for (int i = 0; i < held.size; ++i) {
    const std::int32_t triangle = held.triangle[static_cast<std::size_t>(i)];
    const BallVicinity::Of known = vicinity_->of(triangle);
    if (known.spread_m < 0.0) continue;
    const TouchOf<S> t = touch(*mesh_, triangle, x);
    if (abs(t.d - r_) + r_ * distance<S>(t.n, mesh_->facet(triangle).n) > known.spread_m) continue;
    Check result{.complete = true};
    S least = r_ - rounding_;
    ask_listed(known.on_face, x, held, least, result);
    ask_listed(known.beside, x, held, least, result);
    return result;
  }
  return std::nullopt;
}

template <class Mesh>
bool BallProxyOf<Mesh>::glide(const V& p, Holding& holding, V& x, Check& result) noexcept {
  if (holding.size != 1) return false;
  std::int32_t triangle = holding.triangle[0];
  std::int32_t from = -1;
  for (int edges = 0; edges < most_glides; ++edges) {
    const FacetOf<S>& facet = mesh_->facet(triangle);
    const S pull = r_ - facet.height(p);
    if (!facet.regular || !(pull >= 0.0) || !(facet.height(c_) > 0.0)) return false;
    const V there = p + pull * facet.n;
    if (!(squared_distance<S>(there, c_) <= 0.25 * r_ * r_)) return false;
    // Over the edge that it is farthest outside of.
    std::size_t exit = 3;
    S least = 0.0;
    for (std::size_t e = 0; e < 3; ++e) {
      if (const S s = facet.inside(e, there); s < least) {
        least = s;
        exit = e;
      }
    }
    if (exit == 3) {
      Holding face;
      face.add(triangle);
      if (const auto listed = check_face(there, triangle)) {
        result = *listed;
      } else {
        know_near();
        // Where not all triangles near are known yet there is nothing to ask: advance() will gather them first.
        result = covered(there) ? check(there, face) : Check{};
      }
      if (result.worst >= 0) return false;
      holding = face;
      x = there;
      return true;
    }
    const std::int32_t next = facet.neighbour[exit];
    if (next < 0 || next == from || ignored(next)) return false;
    from = triangle;
    triangle = next;
  }
  return false;
}

template <class Mesh>
bool BallProxyOf<Mesh>::settle(const V& p, Holding& holding, V& x, Check& result) noexcept {
  if (glide(p, holding, x, result)) return true;
  x = c_;
  if (!rest_on(*mesh_, holding, r_, p, rounding_, x) && !roll(p, holding, x)) {
    // Fewer of them may do: the first that leaves the others clear.
    const Holding before = holding;
    bool found = false;
    for (unsigned chosen = 0; chosen + 1 < (1U << before.size) && !found; ++chosen) {
      holding = {};
      for (int i = 0; i < before.size; ++i) {
        if ((chosen >> i & 1U) != 0) holding.add(before.triangle[static_cast<std::size_t>(i)]);
      }
      x = c_;
      if (!rest_on(*mesh_, holding, r_, p, rounding_, x)) continue;
      found = true;
      for (int i = 0; i < before.size && found; ++i) {
        const std::int32_t t = before.triangle[static_cast<std::size_t>(i)];
        if (holding.has(t)) continue;
        const V n = touch(*mesh_, t, c_).n;
        found = dot(n, x - c_) >= -rounding_;
      }
    }
    if (!found) return false;
  }
  for (int round = 0; round < exchanges; ++round) {
    const auto listed = check_listed(x, holding);
    result = listed ? *listed : check(x, holding);
    if (result.worst < 0) return true;
    if (!exchange(p, result.worst, holding, x)) return false;
  }
  return false;
}

template <class Mesh>
bool BallProxyOf<Mesh>::roll(const V& p, Holding& holding, V& x) noexcept {
  if (holding.size == 0) return false;
  const std::int32_t from = holding.triangle[0];
  const TouchOf<S> t = touch(*mesh_, from, c_);
  if (!mesh_->facet(from).regular || t.feature == surface::Feature::face) return false;
  probe_walk_.resume(c_ - t.d * t.n, from);
  if (!probe_walk_.follow(p) || probe_walk_.on() != SurfaceWalkOf<Mesh>::On::face) return false;
  const FacetOf<S>& facet = mesh_->facet(probe_walk_.triangle());
  const V there = p + (r_ - facet.height(p)) * facet.n;
  if (!(squared_distance<S>(there, c_) <= 0.25 * r_ * r_)) return false;
  holding = {};
  holding.add(probe_walk_.triangle());
  x = there;
  return true;
}

template <class Mesh>
bool BallProxyOf<Mesh>::exchange(const V& p, std::int32_t added, Holding& holding, V& x) const noexcept {
  const Holding before = holding;
  const auto try_with = [&](unsigned chosen, Holding& next, V& there) {
    next = {};
    next.add(added);
    for (int i = 0; i < before.size && next.size < 3; ++i) {
      if ((chosen >> i & 1U) != 0) next.add(before.triangle[static_cast<std::size_t>(i)]);
    }
    there = c_;
    if (!rest_on(*mesh_, next, r_, p, rounding_, there)) return false;
    for (int i = 0; i < before.size; ++i) {
      const std::int32_t t = before.triangle[static_cast<std::size_t>(i)];
      if (!next.has(t) && touch(*mesh_, t, there).d < r_ - rounding_) return false;
    }
    return true;
  };
  // Alone it may hold the ball: on a smooth surface nearly always.
  if (Holding next; try_with(0, next, x)) {
    holding = next;
    return true;
  }
  // Else the rest closest to the centre: the one that it would slide to first.
  Holding best;
  V best_x = x;
  S least = std::numeric_limits<double>::infinity();
  // All of three and the added one would be four, which do not hold a ball.
  const unsigned subsets = std::min(1U << before.size, 7U);
  for (unsigned chosen = 1; chosen < subsets; ++chosen) {
    Holding next;
    V there;
    if (!try_with(chosen, next, there)) continue;
    if (const S way = squared_distance<S>(there, c_); way < least) {
      least = way;
      best = next;
      best_x = there;
    }
  }
  if (best.size == 0) return false;
  holding = best;
  x = best_x;
  return true;
}

template <class Mesh>
bool BallProxyOf<Mesh>::advance(const V& x, const Check& checked, const Holding& holding) noexcept {
  if (checked.complete) {
    c_ = x;
    holding_ = holding;
    return true;
  }
  const S length = distance<S>(x, c_);
  if (!covered(x)) {
    // Ahead, where it will be in the next steps, if both ends fit; else only as far as the margin goes.
    if (length <= next_margin_) {
      gather(c_ + std::max(S(0.5), ahead * next_margin_ / length) * (x - c_), next_margin_);
      return false;
    }
    next_margin_ = std::min(length, S(2.0 * next_margin_));
    gather(c_, next_margin_);
    if (length > margin_) {
      constrained_step(c_ + (0.99 * margin_ / length) * (x - c_));
      return false;
    }
    return false;
  }
  if (checked.safe_way || length <= 0.5 * r_) {
    c_ = x;
    holding_ = holding;
    return true;
  }
  const V part = c_ + (0.5 * r_ / length) * (x - c_);
  Holding held = holding;
  V there = c_;
  Check way;
  if (settle(part, held, there, way) && (way.complete || covered(there)) && distance<S>(there, c_) <= r_ &&
      distance<S>(there, c_) > rounding_) {
    c_ = there;
    holding_ = held;
  } else {
    constrained_step(part);
  }
  return false;
}

template <class Mesh>
bool BallProxyOf<Mesh>::constrained_step(const V& goal) noexcept {
  half_spaces_.clear();
  limiting_.clear();
  if (distance<S>(c_, gathered_at_) > 0.75 * margin_) gather(c_, next_margin_);
  const V offset = c_ - gathered_at_;
  // Short moves, for which few triangles matter: not those farther than the move goes.
  const S reach = std::min(distance<S>(goal, c_), S(0.25 * margin_));
  near_.each_below(offset, reach, [&](std::size_t i) {
    const std::int32_t triangle = near_.triangle(i);
    const TouchOf<S> t = touch(*mesh_, triangle, c_);
    if (ignored(triangle)) return;
    near_.set(i, t.n, r_ - t.d + dot(t.n, offset));
    half_spaces_.push_back({t.n, r_ - t.d});
    limiting_.push_back(triangle);
  });
  const NearestInPolyhedronOf<S> found = nearest_in_polyhedron_of<S>(half_spaces_, goal - c_, rounding_);
  if (!found.found) return false;
  holding_ = {};
  for (int i = 0; i < found.basis_size; ++i) {
    const HalfSpaceOf<S>& held = half_spaces_[static_cast<std::size_t>(found.basis[static_cast<std::size_t>(i)])];
    for (std::size_t k = 0; k < half_spaces_.size(); ++k) {
      if (half_spaces_[k].n == held.n && holding_.size < 3 && !holding_.has(limiting_[k])) {
        holding_.add(limiting_[k]);
        break;
      }
    }
  }
  const S length = norm(found.x);
  if (!(length > rounding_)) return false;
  c_ += length > reach ? V(reach / length * found.x) : found.x;
  return true;
}

template <class Mesh>
auto BallProxyOf<Mesh>::contact_places() const noexcept -> ContactPlacesOf<S> {
  ContactPlacesOf<S> contact;
  contact.size = holding_.size;
  for (std::size_t k = 0; k < static_cast<std::size_t>(holding_.size); ++k) {
    const TouchOf<S> t = touch(*mesh_, holding_.triangle[k], c_);
    contact.place[k] = {holding_.triangle[k], t.feature, t.index, c_ - t.d * t.n, t.n};
  }
  return contact;
}

template class BallProxyOf<ContactMesh>;
template class BallProxyOf<CountedContactMesh>;

}  // namespace touchstone::renderers
