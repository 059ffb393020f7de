// The servo step of constraint-based renderers over a scene: the bodies go to their poses, the proxy follows, a spring
// joins proxy and tip.
#pragma once

#include <memory>
#include <utility>

#include "harness/rendering/parameters.h"
#include "harness/rendering/renderer.h"
#include "harness/rendering/scene.h"
#include "renderers/proxy/proxy_renderer.h"
#include "renderers/proxy/scene_proxy.h"

namespace touchstone::renderers {

// `Shading` may turn the force once the proxy is found.
template <class Shading>
class SceneRenderer final : public rendering::Renderer {
 public:
  // `make_shading(bodies)`.
  template <class MakeShading>
  SceneRenderer(double stiffness_N_per_m, std::shared_ptr<const rendering::BodyScene> scene,
                const ConeFriction& friction, MakeShading&& make_shading)
      : stiffness_N_per_m_(stiffness_N_per_m),
        scene_(std::move(scene)),
        bodies_(*scene_),
        shading_(make_shading(bodies_)),
        proxy_(bodies_, friction) {}

  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override { return bodies_.memory_bytes(); }

 private:
  void do_reset() override {
    started_ = false;
    out_of_reach_ = false;
  }

  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    if (!out_of_reach_ && !bodies_.move_to(tip.t_s, !started_)) {
      out_of_reach_ = true;
      out_of_reach_s_ = tip.t_s;
    }
    if (out_of_reach_) {
      rendering::StepResult failed;
      failed.status = rendering::StepStatus::failed;
      return failed;
    }
    return proxy_step<double>(proxy_, started_, tip.p_W_m, stiffness_N_per_m_, bodies_, shading_);
  }

  [[nodiscard]] std::string do_failure() const override {
    return out_of_reach_ ? bodies_.out_of_reach(out_of_reach_s_) : std::string();
  }

  double stiffness_N_per_m_;
  std::shared_ptr<const rendering::BodyScene> scene_;
  PosedBodies bodies_;
  Shading shading_;
  SceneProxy proxy_;
  bool started_ = false;
  bool out_of_reach_ = false;
  double out_of_reach_s_ = 0.0;
};

// Throws BadData for a tip of finite radius: bodies that move against each other are rendered to points.
void check_scene_tip(const rendering::Parameters& parameters);

template <class MakeShading>
std::unique_ptr<rendering::Renderer> make_scene_proxy(const rendering::Parameters& parameters,
                                                      std::shared_ptr<const rendering::BodyScene> scene,
                                                      const ConeFriction& friction, MakeShading make_shading) {
  check_scene_tip(parameters);
  using Shading = decltype(make_shading(std::declval<const PosedBodies&>()));
  return std::make_unique<SceneRenderer<Shading>>(parameters.at("stiffness_N_per_m"), std::move(scene), friction,
                                                  make_shading);
}
inline std::unique_ptr<rendering::Renderer> make_scene_proxy(const rendering::Parameters& parameters,
                                                             std::shared_ptr<const rendering::BodyScene> scene,
                                                             const ConeFriction& friction) {
  return make_scene_proxy(parameters, std::move(scene), friction, [](const PosedBodies&) { return NoShading{}; });
}

}  // namespace touchstone::renderers
