// A renderer whose answers are late by samples that it declares (the parameter lag_samples), asked until each has come:
// so that every answer is held against the tip that it is for.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

class SettledRenderer : public Renderer {
 public:
  SettledRenderer(std::unique_ptr<Renderer> renderer, int lag_samples)
      : renderer_(std::move(renderer)), lag_samples_(lag_samples) {}

 private:
  void do_reset() override {
    renderer_->reset();
    before_s_.reset();
  }
  // The tip stands still for the samples that the answer needs. They lie so close to its time that the first of them,
  // whose answer comes last, has its speed and, in a scene that moves, its poses.
  StepResult do_step(const TipState& tip) noexcept override {
    constexpr double first_s = 1e-3;
    constexpr double spacing = 0.01;  // of the time since the sample before
    const double apart_s = spacing * (tip.t_s - before_s_.value_or(tip.t_s - first_s)) / lag_samples_;
    before_s_ = tip.t_s;
    StepResult answer;
    for (int left = lag_samples_; left >= 0; --left) {
      TipState now = tip;
      now.t_s -= apart_s * left;
      answer = renderer_->step(now);
    }
    return answer;
  }
  [[nodiscard]] std::string do_failure() const override { return renderer_->failure(); }

  std::unique_ptr<Renderer> renderer_;
  int lag_samples_;
  std::optional<double> before_s_;
};

// The renderer itself where it is not late.
inline std::unique_ptr<Renderer> settled(std::unique_ptr<Renderer> renderer, int lag_samples) {
  if (lag_samples <= 0) return renderer;
  return std::make_unique<SettledRenderer>(std::move(renderer), lag_samples);
}

}  // namespace touchstone::rendering
