// Sinusoidal texture: the depth grows by A sin(2 pi (x cos a + y sin a) / wavelength + phase) at the place of the
// foot, the surface point under the tip, in the object's xy plane: a deeply pressed tip on a curved object stands
// elsewhere (Minsky 1995's sandpaper as a height field; normals stay those of the smooth surface, as for amplitudes far
// below the wavelength). A potential in the tip's place for a frozen normal, so conservative to first order.
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect.h"
#include "harness/rendering/effect_traits.h"

namespace touchstone::renderers {

// Values: amplitude_m, wavelength_m, direction_rad, phase_rad. Needs gaps outside contact.
std::unique_ptr<rendering::Effect> make_surface_texture(std::span<const double> values);

// What the search for missing effects is to know of them.
rendering::EffectTraits surface_texture_traits();

}  // namespace touchstone::renderers
