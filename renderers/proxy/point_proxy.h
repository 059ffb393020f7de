// The god-object of a point tip on any mesh: walks on the surface where that is regular (surface_walk.h), and goes by
// planes where it is not (plane_contact.h).
#pragma once

#include "renderers/mesh_traversal/exposed_place.h"
#include "renderers/mesh_traversal/plane_contact.h"
#include "renderers/mesh_traversal/surface_walk.h"

namespace touchstone::renderers {

// Where a walk (surface_walk.h) rests: at one place, or none.
template <class Walk>
RestingPlaceOf<typename Walk::S> resting_place_of(const Walk& walk) noexcept {
  using On = typename Walk::On;
  if (walk.on() == On::nothing) return {};
  const surface::Feature feature = walk.on() == On::face   ? surface::Feature::face
                                   : walk.on() == On::edge ? surface::Feature::edge
                                                           : surface::Feature::vertex;
  return {walk.triangle(), feature, walk.local(), walk.position()};
}

class PointProxy {
 public:
  PointProxy(const ContactMesh& mesh, const surface::Surface& surface, const ConeFriction& friction = {})
      : mesh_(&mesh), surface_(&surface), walk_(mesh, friction), planes_(mesh), cone_(friction) {}

  // The first position of a run: inside a closed body (or behind an open sheet, its rim aside) the god-object starts at
  // the closest surface point.
  void start(const Vec3& p) noexcept;
  void follow(const Vec3& p) noexcept;

  [[nodiscard]] bool touching() const noexcept { return by_planes_ ? planes_.touching() : walk_.touching(); }
  [[nodiscard]] const Vec3& position() const noexcept { return by_planes_ ? planes_.position() : walk_.position(); }
  // From the tip at p to the god-object; zero when free.
  [[nodiscard]] Vec3 push(const Vec3& p) const noexcept { return by_planes_ ? planes_.push(p) : walk_.push(); }
  [[nodiscard]] Vec3 normal(const Vec3& p) const noexcept;
  [[nodiscard]] bool frictionless() const noexcept { return cone_.friction().none(); }
  // For force shading: where it rests while it walks, and on which triangles when it goes by planes.
  [[nodiscard]] RestingPlaceOf<double> resting_place() const noexcept {
    return by_planes_ ? RestingPlaceOf<double>{} : resting_place_of(walk_);
  }
  [[nodiscard]] ContactPlaces contact_places() const noexcept {
    return by_planes_ ? planes_.contact_places() : ContactPlaces{};
  }
  // Beside the mesh's own.
  static std::size_t memory_bytes() noexcept { return 0; }

 private:
  void go_by_planes(const Vec3& p) noexcept;

  const ContactMesh* mesh_;
  const surface::Surface* surface_;
  SurfaceWalk walk_;
  PlaneContact planes_;
  ConeFollower cone_;  // for planes_; the walk has its own
  bool by_planes_ = false;
};

}  // namespace touchstone::renderers
