#include "renderers/counted_god_object.h"

#include "renderers/counted_contact_mesh.h"
#include "renderers/point_proxy.h"
#include "renderers/proxy_renderer.h"

namespace touchstone {
namespace {

// What ProxyRenderer's step wants of a proxy, on a mesh that can be walked on everywhere.
class CountedPointProxy {
 public:
  CountedPointProxy(const CountedContactMesh& mesh, const ConeFriction& friction)
      : walk_(mesh, friction), frictionless_(friction.none()) {}

  SurfaceWalkOf<CountedContactMesh>& walk() { return walk_; }
  [[nodiscard]] bool touching() const noexcept { return walk_.touching(); }
  [[nodiscard]] const Vec3Of<Counted>& position() const noexcept { return walk_.position(); }
  [[nodiscard]] const Vec3Of<Counted>& push(const Vec3Of<Counted>& /*p*/) const noexcept { return walk_.push(); }
  [[nodiscard]] Vec3Of<Counted> normal(const Vec3Of<Counted>& /*p*/) const noexcept { return walk_.normal(); }
  [[nodiscard]] bool frictionless() const noexcept { return frictionless_; }

 private:
  SurfaceWalkOf<CountedContactMesh> walk_;
  bool frictionless_;
};

class CountedGodObject final : public Renderer {
 public:
  CountedGodObject(std::shared_ptr<const Surface> surface, std::shared_ptr<const ContactMesh> mesh,
                   double stiffness_N_per_m, const ConeFriction& friction)
      : surface_(std::move(surface)),
        mesh_(std::move(mesh), *surface_->mesh()),
        stiffness_N_per_m_(stiffness_N_per_m),
        proxy_(mesh_, friction) {}

 private:
  void do_reset() override { started_ = false; }

  StepResult do_step(const TipState& tip) noexcept override {
    const Vec3Of<Counted> p = tip.p_W_m.cast<Counted>();
    if (started_) {
      proxy_.walk().follow(p);
    } else {
      started_ = true;
      const StartPlace place = start_place(mesh_.plain(), *surface_, tip.p_W_m);
      if (place.inside) {
        proxy_.walk().start_on(place.triangle, place.feature, place.index, p);
      } else {
        proxy_.walk().start_free(p);
      }
    }
    return spring_to<Counted>(proxy_, p, stiffness_N_per_m_);
  }

  std::shared_ptr<const Surface> surface_;
  CountedContactMesh mesh_;
  Counted stiffness_N_per_m_;
  CountedPointProxy proxy_;
  bool started_ = false;
};

}  // namespace

std::unique_ptr<Renderer> make_counted_god_object(std::shared_ptr<const Surface> surface, double stiffness_N_per_m,
                                                  const ConeFriction& friction) {
  auto mesh = contact_mesh(surface);
  if (!mesh->regular()) return nullptr;
  return std::make_unique<CountedGodObject>(std::move(surface), std::move(mesh), stiffness_N_per_m, friction);
}

}  // namespace touchstone
