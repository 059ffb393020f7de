// Adhesion: once touched, the surface pulls with F exp(-gap / range) along -n, in contact too (gap 0), until the gap
// exceeds five ranges. Source: an exponential form of the cohesive zone (Rose, Ferrante and Smith 1981) with the
// hysteresis of a bond that forms on touch. Gives no energy over a closed path: the bond is made at zero gap and the
// work of the pull over a retraction is never returned.
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect.h"
#include "harness/rendering/effect_traits.h"

namespace touchstone::renderers {

// Values: force_N, range_m. Needs gaps outside contact.
std::unique_ptr<rendering::Effect> make_adhesion(std::span<const double> values);

// What the search for missing effects is to know of them.
rendering::EffectTraits adhesion_traits();

}  // namespace touchstone::renderers
