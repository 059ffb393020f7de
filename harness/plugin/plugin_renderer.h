// A plug-in's renderer of points as a Renderer, over one object or over the bodies of a scene: numbers go over
// unchanged.
#pragma once

#include <memory>
#include <vector>

#include "harness/plugin/plugin_run.h"
#include "harness/rendering/renderer.h"
#include "harness/rendering/scene.h"

namespace touchstone::plugin {

class PluginRenderer final : public rendering::Renderer {
 public:
  explicit PluginRenderer(PluginRun run) : run_(std::move(run)) {}

 private:
  void do_reset() override { run_.reset(); }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override;
  [[nodiscard]] std::string do_failure() const override { return run_.failure(); }

  PluginRun run_;
};

// Over a scene: the plug-in gets each body's pose at each step.
class PluginSceneRenderer final : public rendering::Renderer {
 public:
  PluginSceneRenderer(PluginRun run, std::shared_ptr<const rendering::BodyScene> scene);

 private:
  void do_reset() override;
  // Failed where the poses do not reach.
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override;
  [[nodiscard]] std::string do_failure() const override;

  PluginRun run_;
  std::shared_ptr<const rendering::BodyScene> scene_;
  std::vector<touchstone2_pose> poses_;
  std::vector<std::size_t> segments_;  // of each body's track
  const rendering::SceneBody* out_of_reach_ = nullptr;
  double out_of_reach_s_ = 0.0;
};

}  // namespace touchstone::plugin
