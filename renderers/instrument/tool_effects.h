// What the tool beyond the sensor adds, in the object's frame with z up:
//   tool-weight   F + m g, g = (0, 0, -9.80665) m/s^2 (standard gravity)
//   tool-inertia  F - m a; a is the second derivative of a quadratic fitted to the positions within half of window_s on
//                 either side (Savitzky and Golay 1964), so that tracker noise is not differentiated sample by sample
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect_traits.h"
#include "harness/rendering/instrument_effect.h"

namespace touchstone::renderers {

std::unique_ptr<rendering::InstrumentEffect> make_tool_weight(std::span<const double> values);   // mass_kg
std::unique_ptr<rendering::InstrumentEffect> make_tool_inertia(std::span<const double> values);  // mass_kg, window_s

// What the search for missing effects is to know of them.
rendering::EffectTraits tool_weight_traits();
rendering::EffectTraits tool_inertia_traits();

}  // namespace touchstone::renderers
