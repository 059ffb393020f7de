#include "renderers/god_object.h"

#include <limits>

#include "renderers/ball_proxy.h"
#include "renderers/contact_mesh.h"
#include "renderers/point_proxy.h"

namespace touchstone {
namespace {

// `Proxy` finds the god-object for the tip: PointProxy or BallProxy.
template <class Proxy>
class GodObject final : public Renderer {
 public:
  template <class... Tip>
  GodObject(double stiffness_N_per_m, std::shared_ptr<const Surface> surface, Tip... tip)
      : stiffness_N_per_m_(stiffness_N_per_m),
        surface_(std::move(surface)),
        mesh_(contact_mesh(surface_)),
        proxy_(*mesh_, *surface_, tip...) {}

 private:
  void do_reset() override { started_ = false; }

  StepResult do_step(const TipState& tip) noexcept override {
    const Vec3& p = tip.p_W_m;
    if (started_) {
      proxy_.follow(p);
    } else {
      started_ = true;
      proxy_.start(p);
    }
    StepResult result;
    result.contact_W_m = proxy_.position();
    if (proxy_.touching()) {
      const Vec3 push = proxy_.push(p);
      result.contact = true;
      result.f_W_N = stiffness_N_per_m_ * push;
      result.n_W = proxy_.normal(p);
      result.depth_m = push.norm();
    }
    return result;
  }

  double stiffness_N_per_m_;
  std::shared_ptr<const Surface> surface_;
  std::shared_ptr<const ContactMesh> mesh_;
  Proxy proxy_;
  bool started_ = false;
};

}  // namespace

RendererEntry god_object_entry() {
  return {
      "god-object",
      "constraint-based: the surface contact point follows the tip outside the surface, a spring joins the two",
      "Zilles and Salisbury 1995",
      {{"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0, "spring from tip to god-object"},
       {"tip_radius_m", "m", 0.0, 1e3, 0.0, "0: a point; else a ball whose centre the positions are"}},
      {{Ability::analytic_surface, "it constrains the god-object by triangles"}},
      [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
        const double stiffness = parameters.at("stiffness_N_per_m");
        const double radius = parameters.at("tip_radius_m");
        if (radius > 0.0) return std::make_unique<GodObject<BallProxy>>(stiffness, std::move(surface), radius);
        return std::make_unique<GodObject<PointProxy>>(stiffness, std::move(surface));
      }};
}

}  // namespace touchstone
