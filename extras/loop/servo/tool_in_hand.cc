#include "servo/tool_in_hand.h"

namespace touchstone::servo {
namespace {

rendering::StepStatus status_of(tool::ToolStatus status) {
  switch (status) {
    case tool::ToolStatus::ok:
      return rendering::StepStatus::ok;
    case tool::ToolStatus::refused:
      return rendering::StepStatus::refused;
    case tool::ToolStatus::failed:
      return rendering::StepStatus::failed;
  }
  return rendering::StepStatus::failed;
}

}  // namespace

void ToolInHand::do_reset() {
  renderer_->reset();
  torque_ = {};
}

rendering::StepResult ToolInHand::do_step(const rendering::TipState& tip) noexcept {
  const tool::ToolResult answer = renderer_->step({tip.t_s, {tip.p_W_m, tip.q_WS}});
  rendering::StepResult out;
  out.status = status_of(answer.status);
  out.f_W_N = answer.f_W_N;
  out.contact = answer.contact;
  out.contact_W_m = answer.contact ? answer.proxy.p_W_m : tip.p_W_m;
  if (answer.contact) {
    const double size_N = answer.f_W_N.norm();
    if (size_N > 0.0) out.n_W = answer.f_W_N / size_N;
    out.depth_m = (answer.proxy.p_W_m - tip.p_W_m).norm();
  }
  const double size_Nm = answer.torque_W_Nm.norm();
  if (size_Nm > torque_.largest_Nm) torque_ = {size_Nm, tip.t_s};
  return out;
}

}  // namespace touchstone::servo
