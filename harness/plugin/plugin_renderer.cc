#include "harness/plugin/plugin_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/rendering/renderer_failed.h"

namespace touchstone::plugin {
namespace {

bool finite(const double* values, std::size_t count) noexcept {
  return std::all_of(values, values + count, [](double value) { return std::isfinite(value); });
}

bool finite(const touchstone_result& result) noexcept {
  return finite(result.f_W_N, 3) && finite(result.contact_W_m, 3) && finite(result.n_W, 3) &&
         std::isfinite(result.depth_m);
}

std::string first_not_finite(const touchstone_result& result) {
  const auto in = [](const char* name, const double* values) -> std::string {
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(values[i])) return fmt::format("{}[{}] = {}", name, i, values[i]);
    }
    return {};
  };
  for (const std::string& found :
       {in("f_W_N", result.f_W_N), in("contact_W_m", result.contact_W_m), in("n_W", result.n_W)}) {
    if (!found.empty()) return found;
  }
  return fmt::format("depth_m = {}", result.depth_m);
}

Vec3 vector(const double* values) { return {values[0], values[1], values[2]}; }

}  // namespace

void PluginRenderer::do_reset() {
  step_ = 0;
  if (state_ == State::broken) throw RendererFailed(do_failure());
  state_ = State::good;
  if (connection_->reset()) return;
  state_ = State::broken;
  throw RendererFailed(do_failure());
}

StepResult PluginRenderer::do_step(const TipState& tip) noexcept {
  StepResult out;
  out.status = StepStatus::failed;
  if (state_ != State::good) return out;
  ++step_;
  last_tip_ = tip;
  const touchstone_tip sent{
      tip.t_s, {tip.p_W_m.x(), tip.p_W_m.y(), tip.p_W_m.z()}, {tip.q_WS.w(), tip.q_WS.x(), tip.q_WS.y(), tip.q_WS.z()}};
  last_result_ = {};
  if (!connection_->step(sent, last_result_)) {
    state_ = State::broken;
    return out;
  }
  if (!finite(last_result_)) {
    state_ = State::not_finite;
    return out;
  }
  out.f_W_N = vector(last_result_.f_W_N);
  out.contact_W_m = vector(last_result_.contact_W_m);
  out.n_W = vector(last_result_.n_W);
  out.depth_m = last_result_.depth_m;
  out.contact = last_result_.contact != 0;
  out.status = StepStatus::ok;
  return out;
}

std::string PluginRenderer::do_failure() const {
  if (state_ == State::good) return {};
  const std::string what = state_ == State::broken
                               ? connection_->failure()
                               : fmt::format("answered {}, which is no finite number", first_not_finite(last_result_));
  if (step_ == 0) return fmt::format("{} {}", name_, what);
  return fmt::format("{} {}, at step {} of its run: t_s = {}, p_W_m = {} {} {}", name_, what, step_, last_tip_.t_s,
                     last_tip_.p_W_m.x(), last_tip_.p_W_m.y(), last_tip_.p_W_m.z());
}

}  // namespace touchstone::plugin
