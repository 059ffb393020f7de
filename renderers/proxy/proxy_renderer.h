// The servo step that all constraint-based renderers share: a proxy that follows the tip on the surface, and a spring
// that joins the two.
#pragma once

#include <memory>
#include <utility>

#include "harness/rendering/renderer.h"
#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::renderers {

// The force as the spring gives it.
struct NoShading {
  template <class Mesh, class Proxy>
  void turn(const Mesh& /*mesh*/, const Proxy& /*proxy*/, rendering::StepResult& /*result*/) const noexcept {}
};

// The force of the spring from p to the proxy, before any shading.
template <class S, class Proxy>
rendering::StepResult spring_to(const Proxy& proxy, const Vec3Of<S>& p, const S& stiffness_N_per_m) noexcept {
  using std::sqrt;
  rendering::StepResult result;
  result.contact_W_m = proxy.position().template cast<double>();
  if (!proxy.touching()) return result;
  const Vec3Of<S>& push = proxy.push(p);
  const Vec3Of<S> n = proxy.normal(p);
  result.contact = true;
  result.f_W_N = (stiffness_N_per_m * push).template cast<double>();
  result.n_W = n.template cast<double>();
  result.depth_m = static_cast<double>(proxy.frictionless() ? S(sqrt(squared_norm(push))) : dot(push, n));
  return result;
}

// A servo step: the proxy starts at p or follows it there, and `shading` may turn the spring's force.
template <class S, class Proxy, class Mesh, class Shading>
rendering::StepResult proxy_step(Proxy& proxy, bool& started, const Vec3Of<S>& p, const S& stiffness_N_per_m,
                                 const Mesh& mesh, Shading& shading) noexcept {
  if (started) {
    proxy.follow(p);
  } else {
    started = true;
    proxy.start(p);
  }
  rendering::StepResult result = spring_to<S>(proxy, p, stiffness_N_per_m);
  if (result.contact) shading.turn(mesh, proxy, result);
  return result;
}

// `Proxy`: PointProxy or BallProxy. `Shading` may turn the force once the proxy is found.
template <class Proxy, class Shading = NoShading>
class ProxyRenderer final : public rendering::Renderer {
 public:
  // `tip`: what the proxy's constructor takes after mesh and surface.
  template <class... Tip>
  ProxyRenderer(double stiffness_N_per_m, std::shared_ptr<const surface::Surface> surface, Shading shading, Tip... tip)
      : stiffness_N_per_m_(stiffness_N_per_m),
        surface_(std::move(surface)),
        mesh_(contact_mesh(surface_)),
        shading_(std::move(shading)),
        proxy_(*mesh_, *surface_, tip...) {}

  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override {
    return mesh_->memory_bytes() + proxy_.memory_bytes();
  }

 private:
  void do_reset() override { started_ = false; }

  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    return proxy_step<double>(proxy_, started_, tip.p_W_m, stiffness_N_per_m_, *mesh_, shading_);
  }

  double stiffness_N_per_m_;
  std::shared_ptr<const surface::Surface> surface_;
  std::shared_ptr<const ContactMesh> mesh_;
  Shading shading_;
  Proxy proxy_;
  bool started_ = false;
};

}  // namespace touchstone::renderers
