#include "renderers/effects/viscous_friction.h"

#include "renderers/effects/rate_plan.h"

namespace touchstone::renderers {
namespace {

class ViscousFriction final : public rendering::Effect {
 public:
  explicit ViscousFriction(double coefficient) : coefficient_(coefficient) {}

  void reset() noexcept override {}

  void apply(rendering::ContactState& contact) noexcept override {
    if (!contact.contact || contact.dt_s <= 0.0) return;
    const Vec3& step = contact.tip_step_W_m;
    contact.tangential_W_N -= coefficient_ / contact.dt_s * (step - contact.n_W.dot(step) * contact.n_W);
  }

 private:
  double coefficient_;
};

}  // namespace

std::unique_ptr<rendering::Effect> make_viscous_friction(std::span<const double> values) {
  return std::make_unique<ViscousFriction>(values[0]);
}

rendering::EffectTraits viscous_friction_traits() {
  rendering::EffectTraits traits;
  traits.follows_speed = true;
  traits.one_sided = {
      {{"coefficient_N_s_per_m", 0.1}},
      0.1,
      "the force along the surface drives the motion, as a viscosity of {:.3g} N s/m would: is the sign "
      "of the force, or the clock, wrong?"};
  traits.plan = [](const rendering::RecordingScales& scales) {
    return plan_of_rate("coefficient_N_s_per_m", scales.force_N, scales.speed_m_per_s);
  };
  return traits;
}

}  // namespace touchstone::renderers
