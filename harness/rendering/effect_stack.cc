#include "harness/rendering/effect_stack.h"

#include <algorithm>

namespace touchstone::rendering {

EffectChain::EffectChain(std::vector<StackedEffect> effects, std::shared_ptr<const surface::Surface> surface,
                         double offset_m, double nominal_stiffness_N_per_m)
    : effects_(std::move(effects)),
      surface_(std::move(surface)),
      offset_m_(offset_m),
      nominal_stiffness_N_per_m_(nominal_stiffness_N_per_m) {
  std::stable_sort(effects_.begin(), effects_.end(),
                   [](const StackedEffect& a, const StackedEffect& b) { return a.phase < b.phase; });
  state_.stiffness_N_per_m = nominal_stiffness_N_per_m_;
  needs_gap_ = std::any_of(effects_.begin(), effects_.end(), [](const StackedEffect& e) { return e.needs_gap; });
}

void EffectChain::reset() {
  for (auto& stacked : effects_) stacked.effect->reset();
  state_ = ContactState{};
  first_ = true;
  was_contact_ = false;
  last_depth_m_ = 0.0;
  state_.stiffness_N_per_m = nominal_stiffness_N_per_m_;
}

void EffectChain::fill_contact(const TipState& tip, const StepResult& base) noexcept {
  state_.dt_s = first_ ? 0.0 : tip.t_s - state_.t_s;
  state_.tip_step_W_m = first_ ? Vec3(Vec3::Zero()) : Vec3(tip.p_W_m - state_.tip_W_m);
  state_.t_s = tip.t_s;
  state_.tip_W_m = tip.p_W_m;
  state_.proxy_W_m = base.contact_W_m;
  state_.contact = base.contact;
  state_.adhesion_N = 0.0;
  if (base.contact) {
    state_.n_W = base.n_W;
    state_.depth_m = base.depth_m;
    state_.normal_force_N = base.f_W_N.dot(base.n_W);
    state_.tangential_W_N = base.f_W_N - state_.normal_force_N * base.n_W;
    if (base.depth_m > 0.0) state_.stiffness_N_per_m = state_.normal_force_N / base.depth_m;
  } else {
    state_.normal_force_N = 0.0;
    state_.tangential_W_N.setZero();
    state_.depth_m = 0.0;
    if (!base.n_W.isZero()) {
      // The base has already measured the gap.
      state_.n_W = base.n_W;
      state_.depth_m = base.depth_m;
      state_.proxy_W_m = tip.p_W_m - (offset_m_ - base.depth_m) * base.n_W;
    } else if (needs_gap_) {
      const surface::SurfacePoint closest = surface_->closest(tip.p_W_m);
      state_.n_W = closest.n_W;
      state_.depth_m = offset_m_ - closest.distance_m;
      state_.proxy_W_m = closest.p_W_m;
    } else {
      state_.n_W.setZero();
    }
  }
}

void EffectChain::act(const TipState& tip, StepResult& result) noexcept {
  fill_contact(tip, result);

  auto next = effects_.begin();
  const auto run = [&](EffectPhase phase) {
    for (; next != effects_.end() && next->phase == phase; ++next) next->effect->apply(state_);
  };
  if (next != effects_.end() && next->phase == EffectPhase::depth) {
    run(EffectPhase::depth);
    state_.contact = state_.depth_m > 0.0 && state_.stiffness_N_per_m > 0.0;
    state_.normal_force_N = state_.contact ? state_.stiffness_N_per_m * state_.depth_m : 0.0;
  }
  state_.depth_rate_m_per_s = 0.0;
  if (state_.contact && state_.dt_s > 0.0) {
    // At the first sample of a contact there is no depth before: the tip came at this speed along the normal.
    const double grown_m = was_contact_ ? state_.depth_m - last_depth_m_ : -state_.n_W.dot(state_.tip_step_W_m);
    state_.depth_rate_m_per_s = grown_m / state_.dt_s;
  }
  run(EffectPhase::stiffness);
  run(EffectPhase::normal_force);
  state_.normal_force_N = state_.contact ? std::max(state_.normal_force_N, 0.0) : 0.0;
  run(EffectPhase::adhesion);
  run(EffectPhase::friction);

  first_ = false;
  was_contact_ = state_.contact;
  last_depth_m_ = state_.depth_m;

  result.contact = state_.contact;
  result.n_W = state_.contact || state_.adhesion_N > 0.0 ? state_.n_W : Vec3(Vec3::Zero());
  result.depth_m = std::max(state_.depth_m, 0.0);
  result.f_W_N = (state_.normal_force_N - state_.adhesion_N) * result.n_W + state_.tangential_W_N;
}

StepResult EffectStack::do_step(const TipState& tip) noexcept {
  StepResult result = base_->step(tip);
  if (result.status != StepStatus::failed) effects_.act(tip, result);
  return result;
}

}  // namespace touchstone::rendering
