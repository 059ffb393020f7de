// A renderer whose answers are late by samples that it declares (the parameter lag_samples), asked until each has come:
// so that a suite holds every answer against the tip that it is for.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "harness/rendering/renderer.h"

namespace touchstone::testing {

class SettledRenderer : public rendering::Renderer {
 public:
  SettledRenderer(std::unique_ptr<rendering::Renderer> renderer, int lag_samples)
      : renderer_(std::move(renderer)), lag_samples_(lag_samples) {}

 private:
  void do_reset() override { renderer_->reset(); }
  // The tip stands still for the samples before its time, in tenths of a millisecond.
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::StepResult answer;
    for (int left = lag_samples_; left >= 0; --left) {
      rendering::TipState now = tip;
      now.t_s -= 1e-4 * left;
      answer = renderer_->step(now);
    }
    return answer;
  }
  [[nodiscard]] std::string do_failure() const override { return renderer_->failure(); }

  std::unique_ptr<rendering::Renderer> renderer_;
  int lag_samples_;
};

// The renderer itself where it is not late.
inline std::unique_ptr<rendering::Renderer> settled(std::unique_ptr<rendering::Renderer> renderer, int lag_samples) {
  if (lag_samples <= 0) return renderer;
  return std::make_unique<SettledRenderer>(std::move(renderer), lag_samples);
}

}  // namespace touchstone::testing
