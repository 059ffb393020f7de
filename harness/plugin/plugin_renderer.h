// A plug-in's renderer as a Renderer: numbers go over unchanged, and what comes back is looked at before it is
// believed.
#pragma once

#include <memory>
#include <string>

#include "harness/base/rooms.h"
#include "harness/plugin/plugin_connection.h"
#include "harness/rendering/renderer.h"

namespace touchstone::plugin {

// A step that fails, or answers with what is no finite number, makes this and every later step StepStatus::failed;
// failure() says how and where in the run.
class PluginRenderer final : public Renderer {
 public:
  // `name` is for messages: "libmine.so: the renderer my-renderer". `keep` lives as long as the renderer.
  PluginRenderer(std::unique_ptr<PluginConnection> connection, std::string name, std::shared_ptr<const void> keep)
      : keep_(std::move(keep)), connection_(std::move(connection)), name_(std::move(name)) {}

 private:
  void do_reset() override;
  StepResult do_step(const TipState& tip) noexcept override;
  [[nodiscard]] std::string do_failure() const override;

  enum class State : std::uint8_t { good, broken, not_finite };

  std::shared_ptr<const void> keep_;
  std::unique_ptr<PluginConnection> connection_;
  std::string name_;
  State state_ = State::good;
  std::uint64_t step_ = 0;
  TipState last_tip_;
  touchstone_result last_result_{};
};

}  // namespace touchstone::plugin
