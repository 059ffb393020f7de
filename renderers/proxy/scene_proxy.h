// The god-object of a point tip among bodies that move against each other.
//
// Sources: C. B. Zilles and J. K. Salisbury 1995 for where it rests; D. C. Ruspini, K. Kolarov and O. Khatib, "Haptic
// interaction in virtual environments", IROS 1997, section 3: before the proxy moves towards the tip, it is moved with
// what moves. A step has three parts:
// - Carried: a god-object that touches goes with the body that presses on it most, at the same place of that body; one
//   in free space goes with the body that it meets first on its way relative to that body. Friction then is that of a
//   body at rest, and acts against the velocity relative to it.
// - Pushed: where its way relative to another body meets that one from the front, it is set in front of the triangle
//   that it met, at the nearest place that is in front of all that push.
// - Towards the tip, as on a body at rest: by walking on one body while no other can be met (surface_walk.h), else by
//   planes (plane_contact.h).
//
// What holds: one body, or all moving together, answers as a body at rest does, to rounding (Galilean invariance).
// A way relative to a body that turns is taken as straight within a step: off by (angle of the step)^2 / 8 times the
// distance from the axis, which no closed body can be passed by, as both ends of the way are looked at. Where bodies
// leave no space the god-object stays at the last place that it had. With friction, between two bodies that move
// differently, it is carried by the one that presses most; Coulomb's law at each would divide it.
#pragma once

#include <cstdint>
#include <vector>

#include "renderers/friction/cone_friction.h"
#include "renderers/mesh_traversal/plane_contact.h"
#include "renderers/mesh_traversal/posed_bodies.h"
#include "renderers/mesh_traversal/surface_walk.h"
#include "renderers/proxy/point_proxy.h"

namespace touchstone::renderers {

class SceneProxy {
 public:
  // The bodies stand where they are at the step at hand.
  SceneProxy(const PosedBodies& bodies, const ConeFriction& friction);

  // The first position of a run: inside a body it starts at the closest place that is reached from outside.
  void start(const Vec3& p) noexcept;
  // The bodies and the tip have moved.
  void follow(const Vec3& p) noexcept;

  [[nodiscard]] bool touching() const noexcept { return walks() ? walk().touching() : planes_.touching(); }
  [[nodiscard]] Vec3 position() const noexcept { return walks() ? body().to_W(walk().position()) : planes_.position(); }
  [[nodiscard]] Vec3 push(const Vec3& p) const noexcept {
    return walks() ? body().direction_to_W(walk().push()) : planes_.push(p);
  }
  [[nodiscard]] Vec3 normal(const Vec3& p) const noexcept;
  [[nodiscard]] bool frictionless() const noexcept { return cone_.friction().none(); }
  [[nodiscard]] RestingPlaceOf<double> resting_place() const noexcept;
  [[nodiscard]] ContactPlaces contact_places() const noexcept {
    return walks() ? ContactPlaces{} : planes_.contact_places();
  }

 private:
  // The two points of planes_ where they were at the last step, and where they are carried to.
  struct Carried {
    Vec3 g = Vec3::Zero();
    Vec3 free_before = Vec3::Zero();
    Vec3 free_now = Vec3::Zero();
  };

  [[nodiscard]] bool walks() const noexcept { return on_body_ >= 0; }
  [[nodiscard]] const PosedBody& body() const noexcept { return bodies_->bodies()[static_cast<std::size_t>(on_body_)]; }
  [[nodiscard]] const SurfaceWalk& walk() const noexcept { return walks_[static_cast<std::size_t>(on_body_)]; }
  [[nodiscard]] SurfaceWalk& walk() noexcept { return walks_[static_cast<std::size_t>(on_body_)]; }

  // One step of the walk on its body; false where it must go on by planes, from `way`.
  bool walk_on(const Vec3& p, Carried& way) noexcept;
  // From walking to planes: where it is on its body now.
  Carried leave_walk(bool flew) noexcept;
  // Whether another body than `own` has a triangle within the radius of p.
  [[nodiscard]] bool others_near(std::size_t own, const Vec3& p, double radius_m) const noexcept;
  // One step from the air; false where it must go on by planes, from `way`.
  bool fly(const Vec3& p, Carried& way) noexcept;
  // The body that the touching god-object goes with.
  [[nodiscard]] std::size_t carrier() const noexcept;
  // The body that one in the air meets first on its way to p, -1 for none.
  [[nodiscard]] int first_met(const Vec3& p) const noexcept;
  // The points of planes_ as they go with that body.
  [[nodiscard]] Carried carried(std::size_t with) const noexcept;
  // From p to all that the step can come upon.
  [[nodiscard]] double reach(std::size_t own, const Carried& way, const Vec3& p) const noexcept;
  void push_out(const Carried& way) noexcept;
  void go_by_planes(const Vec3& p) noexcept;

  const PosedBodies* bodies_;
  std::vector<SurfaceWalk> walks_;  // one per body, in its frame
  PlaneContactOf<PosedBodies> planes_;
  ConeFollower cone_;  // for planes_; a walk has its own
  int on_body_ = -1;   // on which it walks; -1: by planes
  Vec3 tip_ = Vec3::Zero();
};

}  // namespace touchstone::renderers
