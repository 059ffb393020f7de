// A renderer made of a base renderer and the effects of a model file. Itself a Renderer, so that it gets every test
// that a renderer gets. Without effects a model makes the base renderer alone: its output is then the base's to the
// bit.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "harness/rendering/effect.h"
#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"

namespace touchstone::rendering {

struct StackedEffect {
  std::unique_ptr<Effect> effect;
  EffectPhase phase;
  bool needs_gap;  // wants depth_m < 0 outside contact: the stack then asks the surface, which costs a query
};

// The effects alone, acting on what a base renderer has answered.
class EffectChain {
 public:
  // `offset_m`: distance from the surface at which the base renderer's contact begins (its tip radius).
  // `nominal_stiffness_N_per_m`: the base's, for an effect that makes contact where the base has none yet.
  EffectChain(std::vector<StackedEffect> effects, std::shared_ptr<const surface::Surface> surface, double offset_m,
              double nominal_stiffness_N_per_m);
  void reset();
  // Turns what the base answered at this tip into what it is with the effects. Steps in their order.
  void act(const TipState& tip, StepResult& result) noexcept;

 private:
  void fill_contact(const TipState& tip, const StepResult& base) noexcept;

  std::vector<StackedEffect> effects_;
  std::shared_ptr<const surface::Surface> surface_;
  double offset_m_;
  double nominal_stiffness_N_per_m_;
  bool needs_gap_;
  ContactState state_;
  bool first_ = true;
  bool was_contact_ = false;
  double last_depth_m_ = 0.0;
};

class EffectStack final : public Renderer {
 public:
  EffectStack(std::unique_ptr<Renderer> base, EffectChain effects)
      : base_(std::move(base)), effects_(std::move(effects)) {}
  EffectStack(std::unique_ptr<Renderer> base, std::vector<StackedEffect> effects,
              std::shared_ptr<const surface::Surface> surface, double offset_m, double nominal_stiffness_N_per_m)
      : EffectStack(std::move(base),
                    EffectChain(std::move(effects), std::move(surface), offset_m, nominal_stiffness_N_per_m)) {}
  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override { return base_->memory_bytes(); }

 protected:
  void do_reset() override {
    base_->reset();
    effects_.reset();
  }
  // Not here, where compilers would put it into every loop over steps, which then ask each renderer whether it is this.
  StepResult do_step(const TipState& tip) noexcept override;
  [[nodiscard]] std::string do_failure() const override { return base_->failure(); }

 private:
  std::unique_ptr<Renderer> base_;
  EffectChain effects_;
};

}  // namespace touchstone::rendering
