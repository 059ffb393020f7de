#include "renderers/effects/field_effects.h"

#include <cmath>

#include "harness/rendering/smooth_field.h"
#include "renderers/effects/in_frame.h"
#include "renderers/effects/raised_surface.h"

namespace touchstone::renderers {
using rendering::ContactState;
using rendering::Effect;
using rendering::EffectTraits;
using rendering::SmoothField;

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
    // A field bends little over the way that the closest point moves, and its splines are what costs.
    constexpr int looks = 1;
    raise_surface(contact, looks, [this](double x_m, double y_m) noexcept {
      const SmoothField::Value height = field_.with_slope(x_m, y_m);
      return RaisedBy{height.value, height.along_x, height.along_y};
    });
  }

 private:
  SmoothField field_;
};

}  // namespace

std::unique_ptr<Effect> make_stiffness_field(std::span<const double> values) {
  return in_frame(values, std::make_unique<StiffnessField>(values));
}
std::unique_ptr<Effect> make_friction_field(std::span<const double> values) {
  return in_frame(values, std::make_unique<FrictionField>(values));
}
std::unique_ptr<Effect> make_height_field_contact(std::span<const double> values) {
  return in_frame(values, std::make_unique<HeightField>(values));
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
