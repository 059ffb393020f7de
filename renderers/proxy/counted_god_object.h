// The god-object of a point or ball tip with every operation of a step counted: the walk of surface_walk.h and the ball
// of ball_proxy.h over a mesh of counting numbers. The same forces to the bit as those of PointProxy and BallProxy on
// the surface of make_embree_surface().
//
// Counted: the walk, the ball's moves, friction, the spring, shading, and the searches for what a god-object in the air
// meets and for the triangles near a ball, on a plain tree of boxes. Not counted: the queries with which a run starts;
// the exact arithmetic behind the filter that decides which side of a triangle's border a path passes (a handful of
// cases in a million).
#pragma once

#include <memory>
#include <utility>

#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"
#include "renderers/friction/cone_friction.h"
#include "renderers/mesh_traversal/counted_contact_mesh.h"
#include "renderers/proxy/ball_proxy.h"
#include "renderers/proxy/point_proxy.h"
#include "renderers/proxy/proxy_renderer.h"

namespace touchstone::renderers {

// What ProxyRenderer's step wants of a proxy, on a mesh that can be walked on everywhere.
class CountedPointProxy {
 public:
  using Scalar = Counted;
  CountedPointProxy(const CountedContactMesh& mesh, const surface::Surface& surface, const ConeFriction& friction)
      : plain_(&mesh.plain()), surface_(&surface), walk_(mesh, friction), frictionless_(friction.none()) {}

  void start(const Vec3Of<Counted>& p) noexcept {
    const StartPlace place = start_place(*plain_, *surface_, p.cast<double>());
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
  // A walk rests at one place.
  static ContactPlacesOf<Counted> contact_places() noexcept { return {}; }

 private:
  const ContactMesh* plain_;
  const surface::Surface* surface_;
  SurfaceWalkOf<CountedContactMesh> walk_;
  bool frictionless_;
};

// `Proxy`: CountedPointProxy or BallProxyOf<CountedContactMesh>. `tip`: what its constructor takes after mesh and
// surface.
template <class Proxy, class Shading>
class CountedGodObject final : public rendering::Renderer {
 public:
  template <class... Tip>
  CountedGodObject(std::shared_ptr<const surface::Surface> surface, std::shared_ptr<const ContactMesh> mesh,
                   double stiffness_N_per_m, Shading shading, Tip... tip)
      : surface_(std::move(surface)),
        mesh_(std::move(mesh), *surface_->mesh()),
        stiffness_N_per_m_(stiffness_N_per_m),
        shading_(std::move(shading)),
        proxy_(mesh_, *surface_, tip...) {}

 private:
  void do_reset() override { started_ = false; }

  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    const Vec3Of<Counted> p = tip.p_W_m.cast<Counted>();
    return proxy_step<Counted>(proxy_, started_, p, stiffness_N_per_m_, mesh_, shading_);
  }

  std::shared_ptr<const surface::Surface> surface_;
  CountedContactMesh mesh_;
  Counted stiffness_N_per_m_;
  Shading shading_;
  Proxy proxy_;
  bool started_ = false;
};

// nullptr for a point tip where the mesh has triangles that cannot be walked on (Facet::regular): the way over those is
// not counted.
template <class Shading>
std::unique_ptr<rendering::Renderer> make_counted_proxy(std::shared_ptr<const surface::Surface> surface,
                                                        double stiffness_N_per_m, double tip_radius_m,
                                                        const ConeFriction& friction, Shading shading) {
  auto mesh = contact_mesh(surface);
  if (tip_radius_m > 0.0)
    return std::make_unique<CountedGodObject<BallProxyOf<CountedContactMesh>, Shading>>(
        std::move(surface), std::move(mesh), stiffness_N_per_m, std::move(shading), tip_radius_m, friction);
  if (!mesh->regular()) return nullptr;
  return std::make_unique<CountedGodObject<CountedPointProxy, Shading>>(
      std::move(surface), std::move(mesh), stiffness_N_per_m, std::move(shading), friction);
}
std::unique_ptr<rendering::Renderer> make_counted_god_object(std::shared_ptr<const surface::Surface> surface,
                                                             double stiffness_N_per_m, double tip_radius_m,
                                                             const ConeFriction& friction);

}  // namespace touchstone::renderers
