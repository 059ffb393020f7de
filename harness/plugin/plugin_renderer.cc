#include "harness/plugin/plugin_renderer.h"

namespace touchstone::plugin {
using rendering::StepResult;

namespace {

StepResult result_of(const touchstone2_result* made) noexcept {
  StepResult out;
  if (made == nullptr) {
    out.status = rendering::StepStatus::failed;
    return out;
  }
  out.f_W_N = vector_of(made->f_W_N);
  out.contact_W_m = vector_of(made->proxy.p_W_m);
  out.n_W = vector_of(made->n_W);
  out.depth_m = made->depth_m;
  out.contact = made->contact != 0;
  return out;
}

}  // namespace

StepResult PluginRenderer::do_step(const rendering::TipState& tip) noexcept {
  return result_of(run_.step(tip.t_s, pose_of(tip.p_W_m, tip.q_WS)));
}

PluginSceneRenderer::PluginSceneRenderer(PluginRun run, std::shared_ptr<const rendering::BodyScene> scene)
    : run_(std::move(run)),
      scene_(std::move(scene)),
      poses_(scene_->bodies.size(), identity_pose),
      segments_(scene_->bodies.size(), 0) {}

void PluginSceneRenderer::do_reset() {
  out_of_reach_ = nullptr;
  run_.reset();
}

StepResult PluginSceneRenderer::do_step(const rendering::TipState& tip) noexcept {
  for (std::size_t i = 0; i < poses_.size() && out_of_reach_ == nullptr; ++i) {
    const rendering::SceneBody& body = scene_->bodies[i];
    if (!body.pose.covers(tip.t_s)) {
      out_of_reach_ = &body;
      out_of_reach_s_ = tip.t_s;
      break;
    }
    const rendering::BodyPose now = body.pose.at(tip.t_s, segments_[i]);
    poses_[i] = pose_of(now.p_W_m, now.q_WB);
  }
  if (out_of_reach_ != nullptr) return result_of(nullptr);
  return result_of(run_.step(tip.t_s, pose_of(tip.p_W_m, tip.q_WS), poses_));
}

std::string PluginSceneRenderer::do_failure() const {
  return out_of_reach_ != nullptr ? out_of_reach_->pose.out_of_reach(out_of_reach_s_) : run_.failure();
}

}  // namespace touchstone::plugin
