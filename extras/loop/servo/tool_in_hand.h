// A renderer of a tool with a shape (harness/tool) as the loop drives one: the hand holds the tool by its handle, whose
// three translational axes the device drives. The orientation is the path's: on a device of three actuated axes, like
// the Touch or the omega.3, the gimbal is measured and not driven. So the torque acts on nobody and is only reported.
//
// The contact's normal, along which virtual damping acts, is the direction of the force; the contact point is the
// origin of the proxy.
#pragma once

#include <memory>
#include <utility>

#include "harness/rendering/renderer.h"
#include "harness/tool/tool_renderer.h"

namespace touchstone::servo {

class ToolInHand final : public rendering::Renderer {
 public:
  explicit ToolInHand(std::unique_ptr<tool::ToolRenderer> renderer) : renderer_(std::move(renderer)) {}

  // About the handle, since the last reset.
  struct Torque {
    double largest_Nm = 0.0;
    double at_s = 0.0;
  };
  [[nodiscard]] const Torque& torque() const noexcept { return torque_; }
  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override { return renderer_->memory_bytes(); }

 protected:
  void do_reset() override;
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override;
  [[nodiscard]] std::string do_failure() const override { return renderer_->failure(); }

 private:
  std::unique_ptr<tool::ToolRenderer> renderer_;
  Torque torque_;
};

}  // namespace touchstone::servo
