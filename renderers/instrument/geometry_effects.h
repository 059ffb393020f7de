// Where the measurement's geometry is off:
//   registration      measured = true + d + r x (true - pivot), d = (dx, dy, dz), r = (rx, ry, rz); solved exactly
//                     for the true tip. The pivot is the object's origin unless it is given
//                     (harness/rendering/surface_frame.h)
//   tracker-scale     measured = pivot + (1 + scale) (true - pivot)
//   surface-geometry  the true surface carries a Gaussian bump that the mesh lacks, A exp(-r^2 / 2 w^2) outward,
//                     r the distance of the place on the true surface from (x, y) in the xy plane of the
//                     object, or of the bump's frame
//   height-field      the same for a smooth height all over the surface
// How depth and normal follow from a height: renderers/effects/raised_surface.h.
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect_traits.h"
#include "harness/rendering/instrument_effect.h"

namespace touchstone::renderers {

std::unique_ptr<rendering::InstrumentEffect> make_registration(
    std::span<const double> values);  // dx_m, dy_m, dz_m, rx_rad, ry_rad, rz_rad, pivot_x_m, pivot_y_m, pivot_z_m
std::unique_ptr<rendering::InstrumentEffect> make_tracker_scale(
    std::span<const double> values);  // scale, pivot_x_m, pivot_y_m, pivot_z_m
std::unique_ptr<rendering::InstrumentEffect> make_surface_geometry(
    std::span<const double> values);  // amplitude_m, x_m, y_m, width_m, and the frame's
// Values in the order of field_parameters() (harness/rendering/smooth_field.h).
std::unique_ptr<rendering::InstrumentEffect> make_height_field(std::span<const double> values);

// What the search for missing effects is to know of them.
rendering::EffectTraits registration_traits();
rendering::EffectTraits tracker_scale_traits();
rendering::EffectTraits surface_geometry_traits();
rendering::EffectTraits height_field_traits();

}  // namespace touchstone::renderers
