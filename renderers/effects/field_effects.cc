#include "renderers/effects/field_effects.h"

#include <cmath>

#include "harness/rendering/smooth_field.h"

namespace touchstone::renderers {
namespace {

class StiffnessField final : public Effect {
 public:
  explicit StiffnessField(std::span<const double> values) : field_(values) {}
  void reset() noexcept override {}
  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) return;
    contact.normal_force_N *= std::exp(field_.at(contact.proxy_W_m.x(), contact.proxy_W_m.y()));
  }

 private:
  SmoothField field_;
};

class FrictionField final : public Effect {
 public:
  explicit FrictionField(std::span<const double> values) : field_(values) {}
  void reset() noexcept override {}
  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) return;
    contact.tangential_W_N *= std::exp(field_.at(contact.proxy_W_m.x(), contact.proxy_W_m.y()));
  }

 private:
  SmoothField field_;
};

class HeightField final : public Effect {
 public:
  explicit HeightField(std::span<const double> values) : field_(values) {}
  void reset() noexcept override {}
  void apply(ContactState& contact) noexcept override {
    if (contact.n_W.isZero()) return;  // far from the surface
    const SmoothField::Value height = field_.with_slope(contact.proxy_W_m.x(), contact.proxy_W_m.y());
    contact.depth_m += height.value;
    Vec3 slope(height.along_x, height.along_y, 0.0);
    slope -= contact.n_W.dot(slope) * contact.n_W;
    contact.n_W = (contact.n_W - slope).normalized();
  }

 private:
  SmoothField field_;
};

}  // namespace

std::unique_ptr<Effect> make_stiffness_field(std::span<const double> values) {
  return std::make_unique<StiffnessField>(values);
}
std::unique_ptr<Effect> make_friction_field(std::span<const double> values) {
  return std::make_unique<FrictionField>(values);
}
std::unique_ptr<Effect> make_height_field_contact(std::span<const double> values) {
  return std::make_unique<HeightField>(values);
}

EffectTraits stiffness_field_traits() {
  EffectTraits traits;
  traits.contains = {"stiffness-map"};
  traits.map_title = "Stiffness over the renderer's";
  return traits;
}

EffectTraits friction_field_traits() {
  EffectTraits traits;
  traits.map_title = "Friction over that of the effects before it";
  return traits;
}

}  // namespace touchstone::renderers
