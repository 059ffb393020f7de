#include "renderers/proxy/scene_proxy.h"

#include <algorithm>
#include <array>
#include <span>

#include "renderers/friction/nearest_in_polyhedron.h"
#include "renderers/friction/shares.h"
#include "renderers/mesh_traversal/exposed_place.h"
#include "renderers/mesh_traversal/front_crossing.h"

namespace touchstone::renderers {
namespace {

// Bodies that push at the same time: after as many rounds the god-object stays where it is.
constexpr int pushes = 16;
// Walking needs that nothing else is within reach, rounding aside.
constexpr double reach_factor = 1.0 + 1e-9;

}  // namespace

SceneProxy::SceneProxy(const PosedBodies& bodies, const ConeFriction& friction)
    : bodies_(&bodies), planes_(bodies), cone_(friction) {
  for (const PosedBody& body : bodies.bodies()) walks_.emplace_back(body.mesh(), friction);
}

void SceneProxy::start(const Vec3& p) noexcept {
  on_body_ = -1;
  tip_ = p;
  cone_.stick();
  const StartPlace place = start_place(*bodies_, p);
  if (!place.inside) return planes_.start_free(p);
  planes_.start_on(place.triangle, place.p_W_m);
  go_by_planes(p);
}

void SceneProxy::follow(const Vec3& p) noexcept {
  Carried way;
  const bool walked = walks();
  const bool flies = !walked && !planes_.touching();
  bool done = false;
  if (walked) {
    done = walk_on(p, way);
  } else if (flies) {
    done = fly(p, way);
  } else {
    way = carried(carrier());
  }
  if (!done) {
    if (bodies_->moved()) push_out(way);
    go_by_planes(p);
  }
  tip_ = p;
}

bool SceneProxy::fly(const Vec3& p, Carried& way) noexcept {
  const int first = first_met(p);
  if (first < 0) {
    planes_.start_free(p);
    return true;
  }
  way = carried(static_cast<std::size_t>(first));
  const auto own = static_cast<std::size_t>(first);
  const PosedBody& on = bodies_->bodies()[own];
  if (others_near(own, p, reach_factor * reach(own, way, p))) return false;
  // Nothing but this body: it lands as on a body at rest.
  on_body_ = first;
  walk().start_free(on.to_B(way.free_now));
  if (walk().follow(on.to_B(p)) && walk().touching()) return true;
  on_body_ = -1;
  return false;
}

double SceneProxy::reach(std::size_t own, const Carried& way, const Vec3& p) const noexcept {
  double swept_m = 0.0;
  if (bodies_->moved()) {
    for (std::size_t i = 0; i < bodies_->bodies().size(); ++i) {
      const PosedBody& other = bodies_->bodies()[i];
      if (i != own) swept_m = std::max(swept_m, (other.to_B(way.free_now) - other.before_to_B(way.free_before)).norm());
    }
  }
  return (p - way.free_now).norm() + swept_m;
}

bool SceneProxy::walk_on(const Vec3& p, Carried& way) noexcept {
  const auto own = static_cast<std::size_t>(on_body_);
  const PosedBody& on = bodies_->bodies()[own];
  // All of the walk's way is nearer to the tip than where it starts; what comes has swept as far as it moved.
  const Vec3 g = on.to_W(walk().position());
  way = {g, on.before_to_W(walk().position()), g};
  bool flew = false;
  if (!others_near(own, p, reach_factor * reach(own, way, p))) {
    if (walk().follow(on.to_B(p))) {
      if (!walk().touching()) {
        planes_.start_free(p);
        on_body_ = -1;
      }
      return true;
    }
    flew = walk().flew();
  }
  way = leave_walk(flew);
  return false;
}

SceneProxy::Carried SceneProxy::leave_walk(bool flew) noexcept {
  const PosedBody& on = body();
  cone_.resume(walk().sliding());
  if (flew) {
    planes_.start_free(on.to_W(walk().took_off()));
  } else {
    planes_.start_on(walk().triangle() + on.first_triangle(), on.to_W(walk().position()));
  }
  on_body_ = -1;
  const Vec3& free = planes_.free_point();
  return {planes_.position(), on.before_to_W(on.to_B(free)), free};
}

bool SceneProxy::others_near(std::size_t own, const Vec3& p, double radius_m) const noexcept {
  const auto& all = bodies_->bodies();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == own) continue;
    const double reach = all[i].radius() + radius_m;
    if ((all[i].center() - p).squaredNorm() > reach * reach) continue;
    bool near = false;
    all[i].mesh().tree().within(all[i].to_B(p), radius_m, [&](std::int32_t) {
      near = true;
      return 0.0;
    });
    if (near) return true;
  }
  return false;
}

std::size_t SceneProxy::carrier() const noexcept {
  const ContactPlaces contact = planes_.contact_places();
  std::size_t most = 0;
  if (contact.size > 1) {
    const Vec3 share = shares<double>(contact, planes_.position() - tip_);
    for (std::size_t k = 1; k < static_cast<std::size_t>(contact.size); ++k) {
      if (share[static_cast<Eigen::Index>(k)] > share[static_cast<Eigen::Index>(most)]) most = k;
    }
  }
  return bodies_->body_of(contact.place[most].triangle);
}

int SceneProxy::first_met(const Vec3& p) const noexcept {
  int first = -1;
  double least = 1.0;
  const auto& all = bodies_->bodies();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const FrontCrossing hit = first_front_crossing(all[i].mesh(), all[i].before_to_B(planes_.free_point()),
                                                   all[i].to_B(p), [](std::int32_t) { return false; });
    if (hit.triangle < 0 || (first >= 0 && !(hit.fraction < least))) continue;
    least = hit.fraction;
    first = static_cast<int>(i);
  }
  return first;
}

SceneProxy::Carried SceneProxy::carried(std::size_t with) const noexcept {
  const PosedBody& body = bodies_->bodies()[with];
  const Vec3& free = planes_.free_point();
  return {body.to_W(body.before_to_B(planes_.position())), free, body.to_W(body.before_to_B(free))};
}

void SceneProxy::push_out(const Carried& way) noexcept {
  std::array<HalfSpace, 4> pushing;
  std::size_t count = 0;
  Vec3 x = way.free_now;
  bool has_space = false;
  for (int round = 0; round < pushes; ++round) {
    std::int32_t met = -1;
    for (const PosedBody& body : bodies_->bodies()) {
      const FrontCrossing hit = first_front_crossing(body.mesh(), body.before_to_B(way.free_before), body.to_B(x),
                                                     [](std::int32_t) { return false; });
      if (hit.triangle < 0) continue;
      met = hit.triangle + body.first_triangle();
      break;
    }
    if (met < 0) {
      has_space = true;
      break;
    }
    const Facet facet = bodies_->facet(met);
    pushing[count++] = {facet.n, planes_.lift() - facet.height(way.free_now)};
    const auto nearest =
        nearest_in_polyhedron(std::span(pushing.data(), count), Vec3::Zero(), resting_error(*bodies_, way.free_now));
    if (!nearest.found) break;
    x = way.free_now + nearest.x;
    // Only those that press are kept: a fourth has room again.
    std::array<HalfSpace, 4> kept;
    count = 0;
    for (int i = 0; i < nearest.basis_size; ++i)
      kept[count++] = pushing[static_cast<std::size_t>(nearest.basis[static_cast<std::size_t>(i)])];
    pushing = kept;
  }
  // Between bodies that leave none it stays at its place on the body that it goes with, and keeps what holds it there:
  // a place in front of one of them would be inside another, which would let go of it.
  if (!has_space || x == way.free_now) {
    planes_.carry(way.g, way.free_now);
  } else {
    planes_.start_lifted(x);
  }
}

void SceneProxy::go_by_planes(const Vec3& p) noexcept {
  if (cone_.friction().none()) {
    planes_.pull(p);
  } else {
    cone_.follow(planes_, p, resting_error(*bodies_, planes_.position()));
  }
  if (!planes_.touching()) return planes_.start_free(planes_.position());
  const std::int32_t single = planes_.single();
  if (single < 0) return;
  const std::size_t own = bodies_->body_of(single);
  const PosedBody& on = bodies_->bodies()[own];
  const std::int32_t local = single - on.first_triangle();
  if (!on.mesh().facet(local).regular) return;
  if (others_near(own, p, reach_factor * (p - planes_.position()).norm())) return;
  // Alone on a body that can be walked on.
  on_body_ = static_cast<int>(own);
  walk().resume(on.to_B(planes_.position()), local, cone_.sliding());
  if (!walk().follow(on.to_B(p)) || !walk().touching()) on_body_ = -1;
}

Vec3 SceneProxy::normal(const Vec3& p) const noexcept {
  if (walks()) return body().direction_to_W(walk().normal());
  return cone_.friction().none() ? planes_.normal(p)
                                 : cone_normal(planes_, p, resting_error(*bodies_, planes_.position()));
}

RestingPlaceOf<double> SceneProxy::resting_place() const noexcept {
  if (!walks()) return {};
  RestingPlaceOf<double> place = resting_place_of(walk());
  place.triangle += body().first_triangle();
  place.p = body().to_W(place.p);
  return place;
}

}  // namespace touchstone::renderers
