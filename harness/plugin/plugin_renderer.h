// A plug-in's renderer of points as a Renderer: numbers go over unchanged.
#pragma once

#include "harness/base/rooms.h"
#include "harness/plugin/plugin_run.h"
#include "harness/rendering/renderer.h"

namespace touchstone::plugin {

class PluginRenderer final : public Renderer {
 public:
  explicit PluginRenderer(PluginRun run) : run_(std::move(run)) {}

 private:
  void do_reset() override { run_.reset(); }
  StepResult do_step(const TipState& tip) noexcept override;
  [[nodiscard]] std::string do_failure() const override { return run_.failure(); }

  PluginRun run_;
};

}  // namespace touchstone::plugin
