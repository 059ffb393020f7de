// Where the measurement's geometry is off:
//   registration      measured = true + d + r x true, d = (dx, dy, dz), r = (rx, ry, 0); solved exactly for the
//                     true tip
//   surface-geometry  the true surface carries a Gaussian bump that the mesh lacks, A exp(-r^2 / 2 w^2) outward,
//                     r the distance of the place on the true surface from (x, y) in the object's xy plane
//   height-field      the same for a smooth height all over the surface
// How depth and normal follow from a height: renderers/effects/raised_surface.h.
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect_traits.h"
#include "harness/rendering/instrument_effect.h"

namespace touchstone::renderers {

std::unique_ptr<rendering::InstrumentEffect> make_registration(
    std::span<const double> values);  // dx_m, dy_m, dz_m, rx_rad, ry_rad
std::unique_ptr<rendering::InstrumentEffect> make_surface_geometry(
    std::span<const double> values);  // amplitude_m, x_m, y_m, width_m
// Values in the order of field_parameters() (harness/rendering/smooth_field.h).
std::unique_ptr<rendering::InstrumentEffect> make_height_field(std::span<const double> values);

// What the search for missing effects is to know of them.
rendering::EffectTraits registration_traits();
rendering::EffectTraits surface_geometry_traits();
rendering::EffectTraits height_field_traits();

}  // namespace touchstone::renderers
