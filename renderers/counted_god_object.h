// The god-object of a point tip with every operation of a step counted: the walk of surface_walk.h over a mesh of
// counting numbers. The same forces to the bit as PointProxy's on the surface of make_embree_surface().
//
// Counted: the walk, friction, the spring, shading, and the search for what a god-object in the air meets, on a plain
// tree of boxes. Not counted: the query of the first step of a run for whether it starts inside; the exact arithmetic
// behind the filter that decides which side of a triangle's border a path passes (a handful of cases in a million).
#pragma once

#include <memory>
#include <utility>

#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"
#include "renderers/cone_friction.h"
#include "renderers/counted_contact_mesh.h"
#include "renderers/point_proxy.h"
#include "renderers/proxy_renderer.h"

namespace touchstone {

// What ProxyRenderer's step wants of a proxy, on a mesh that can be walked on everywhere.
class CountedPointProxy {
 public:
  CountedPointProxy(const CountedContactMesh& mesh, const ConeFriction& friction)
      : walk_(mesh, friction), frictionless_(friction.none()) {}

  void start(const StartPlace& place, const Vec3Of<Counted>& p) noexcept {
    if (place.inside) {
      walk_.start_on(place.triangle, place.feature, place.index, p);
    } else {
      walk_.start_free(p);
    }
  }
  void follow(const Vec3Of<Counted>& p) noexcept { walk_.follow(p); }

  [[nodiscard]] bool touching() const noexcept { return walk_.touching(); }
  [[nodiscard]] const Vec3Of<Counted>& position() const noexcept { return walk_.position(); }
  [[nodiscard]] const Vec3Of<Counted>& push(const Vec3Of<Counted>& /*p*/) const noexcept { return walk_.push(); }
  [[nodiscard]] Vec3Of<Counted> normal(const Vec3Of<Counted>& /*p*/) const noexcept { return walk_.normal(); }
  [[nodiscard]] bool frictionless() const noexcept { return frictionless_; }
  [[nodiscard]] RestingPlaceOf<Counted> resting_place() const noexcept { return resting_place_of(walk_); }

 private:
  SurfaceWalkOf<CountedContactMesh> walk_;
  bool frictionless_;
};

template <class Shading>
class CountedGodObject final : public Renderer {
 public:
  CountedGodObject(std::shared_ptr<const Surface> surface, std::shared_ptr<const ContactMesh> mesh,
                   double stiffness_N_per_m, const ConeFriction& friction, Shading shading)
      : surface_(std::move(surface)),
        mesh_(std::move(mesh), *surface_->mesh()),
        stiffness_N_per_m_(stiffness_N_per_m),
        shading_(std::move(shading)),
        proxy_(mesh_, friction) {}

 private:
  void do_reset() override { started_ = false; }

  StepResult do_step(const TipState& tip) noexcept override {
    const Vec3Of<Counted> p = tip.p_W_m.cast<Counted>();
    if (started_) {
      proxy_.follow(p);
    } else {
      started_ = true;
      proxy_.start(start_place(mesh_.plain(), *surface_, tip.p_W_m), p);
    }
    StepResult result = spring_to<Counted>(proxy_, p, stiffness_N_per_m_);
    if (result.contact) shading_.turn(mesh_, proxy_, result);
    return result;
  }

  std::shared_ptr<const Surface> surface_;
  CountedContactMesh mesh_;
  Counted stiffness_N_per_m_;
  Shading shading_;
  CountedPointProxy proxy_;
  bool started_ = false;
};

// nullptr where the mesh has triangles that cannot be walked on (Facet::regular): the way over those is not counted.
template <class Shading>
std::unique_ptr<Renderer> make_counted_proxy(std::shared_ptr<const Surface> surface, double stiffness_N_per_m,
                                             const ConeFriction& friction, Shading shading) {
  auto mesh = contact_mesh(surface);
  if (!mesh->regular()) return nullptr;
  return std::make_unique<CountedGodObject<Shading>>(std::move(surface), std::move(mesh), stiffness_N_per_m, friction,
                                                     std::move(shading));
}
std::unique_ptr<Renderer> make_counted_god_object(std::shared_ptr<const Surface> surface, double stiffness_N_per_m,
                                                  const ConeFriction& friction);

}  // namespace touchstone
