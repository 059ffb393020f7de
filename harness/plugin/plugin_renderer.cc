#include "harness/plugin/plugin_renderer.h"

namespace touchstone::plugin {

StepResult PluginRenderer::do_step(const TipState& tip) noexcept {
  StepResult out;
  const touchstone2_result* const made = run_.step(tip.t_s, pose_of(tip.p_W_m, tip.q_WS));
  if (made == nullptr) {
    out.status = StepStatus::failed;
    return out;
  }
  out.f_W_N = vector_of(made->f_W_N);
  out.contact_W_m = vector_of(made->proxy.p_W_m);
  out.n_W = vector_of(made->n_W);
  out.depth_m = made->depth_m;
  out.contact = made->contact != 0;
  return out;
}

}  // namespace touchstone::plugin
