#include "renderers/devices/haptic_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/rendering/named_declaration.h"

namespace touchstone::renderers {
using rendering::Renderer;
using rendering::StepResult;
using rendering::TipState;

namespace {

class HapticDevice final : public Renderer {
 public:
  HapticDevice(std::unique_ptr<Renderer> rendering, const DeviceLimits& limits)
      : rendering_(std::move(rendering)), limits_(limits) {}

  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override { return rendering_->memory_bytes(); }

 private:
  void do_reset() override {
    rendering_->reset();
    started_ = false;
    held_ = {};
    felt_W_N_.setZero();
  }

  [[nodiscard]] Vec3 resolved(const Vec3& p) const {
    if (!(limits_.resolution_m > 0.0)) return p;
    return (p.array() / limits_.resolution_m).round() * limits_.resolution_m;
  }

  void run_servo(const TipState& tip) noexcept {
    TipState seen = tip;
    seen.p_W_m = resolved(tip.p_W_m);
    held_ = rendering_->step(seen);
    if (held_.status == rendering::StepStatus::failed) return;
    double magnitude = held_.f_W_N.norm();
    double most = magnitude;
    if (limits_.stiffness_limit_N_per_m > 0.0) most = std::min(most, limits_.stiffness_limit_N_per_m * held_.depth_m);
    if (limits_.force_limit_N > 0.0) most = std::min(most, limits_.force_limit_N);
    if (most < magnitude) held_.f_W_N *= most / magnitude;
  }

  StepResult do_step(const TipState& tip) noexcept override {
    const double dt_s = started_ ? tip.t_s - last_t_s_ : 0.0;
    // A thousandth of a period of slack: rounding of the clock must not cost a period.
    if (!started_ || tip.t_s - servo_t_s_ >= 0.999 * limits_.servo_period_s) {
      run_servo(tip);
      servo_t_s_ = tip.t_s;
    }
    if (held_.status == rendering::StepStatus::failed) return held_;
    if (limits_.time_constant_s > 0.0 && started_) {
      felt_W_N_ += (1.0 - std::exp(-dt_s / limits_.time_constant_s)) * (commanded_W_N_ - felt_W_N_);
    } else {
      felt_W_N_ = limits_.time_constant_s > 0.0 ? Vec3(Vec3::Zero()) : held_.f_W_N;
    }
    commanded_W_N_ = held_.f_W_N;
    started_ = true;
    last_t_s_ = tip.t_s;
    StepResult result = held_;
    result.f_W_N = felt_W_N_;
    return result;
  }

  [[nodiscard]] std::string do_failure() const override { return rendering_->failure(); }

  std::unique_ptr<Renderer> rendering_;
  DeviceLimits limits_;
  bool started_ = false;
  double last_t_s_ = 0.0;
  double servo_t_s_ = 0.0;
  StepResult held_;
  Vec3 commanded_W_N_ = Vec3::Zero();
  Vec3 felt_W_N_ = Vec3::Zero();
};

}  // namespace

const rendering::NamedDeclaration& haptic_device_declaration() {
  static const rendering::NamedDeclaration declaration{
      "haptic-device",
      "what a device makes of a rendering: servo period, resolution, stiffness and force limits, first-order dynamics",
      {{"servo_period_s", "s", 0.0, 1.0, 0.0, "the renderer runs once per period; 0: at every step"},
       {"resolution_m", "m", 0.0, 1.0, 0.0, "of each coordinate of the tip; 0: exact"},
       {"stiffness_limit_N_per_m", "N/m", 0.0, 1e9, 0.0, "the stiffest contact that the device shows; 0: none"},
       {"force_limit_N", "N", 0.0, 1e6, 0.0, "the largest force; 0: none"},
       {"time_constant_s", "s", 0.0, 10.0, 0.0, "of the force behind the command; 0: at once"}}};
  return declaration;
}

std::optional<DeviceLimits> take_haptic_device(rendering::Model& model) {
  const auto is_device = [](const rendering::NamedParameters& effect) {
    return effect.name == haptic_device_declaration().name;
  };
  const auto found = std::find_if(model.effects.begin(), model.effects.end(), is_device);
  if (found == model.effects.end()) return std::nullopt;
  const auto second = std::find_if(found + 1, model.effects.end(), is_device);
  if (second != model.effects.end()) {
    throw BadData(
        fmt::format("{}: {}: a second haptic-device; a rendering is felt through one", model.source, second->place));
  }
  const rendering::Parameters p(haptic_device_declaration().parameters, found->parameters, "effect haptic-device",
                                model.source, found->place);
  model.effects.erase(found);
  return DeviceLimits{p.at("servo_period_s"), p.at("resolution_m"), p.at("stiffness_limit_N_per_m"),
                      p.at("force_limit_N"), p.at("time_constant_s")};
}

std::unique_ptr<Renderer> make_haptic_device(std::unique_ptr<Renderer> rendering, const DeviceLimits& limits) {
  return std::make_unique<HapticDevice>(std::move(rendering), limits);
}

}  // namespace touchstone::renderers
