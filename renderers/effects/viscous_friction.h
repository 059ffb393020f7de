// Viscous friction: f_t = -b v_t while in contact (Newton's law of viscosity lumped). Dissipative for b >= 0.
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect.h"
#include "harness/rendering/effect_traits.h"

namespace touchstone::renderers {

// Values: coefficient_N_s_per_m.
std::unique_ptr<rendering::Effect> make_viscous_friction(std::span<const double> values);

// What the search for missing effects is to know of them.
rendering::EffectTraits viscous_friction_traits();

}  // namespace touchstone::renderers
