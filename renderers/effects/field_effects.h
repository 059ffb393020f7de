// Properties that differ smoothly over the object's surface (harness/rendering/smooth_field.h), for objects that no
// single bump describes.
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect.h"
#include "harness/rendering/effect_traits.h"

namespace touchstone::renderers {

// Values in the order of field_parameters().
// The stiffness at the contact point is exp(field) times the renderer's.
std::unique_ptr<rendering::Effect> make_stiffness_field(std::span<const double> values);
// The force along the surface is exp(field) times what the friction before it in the model makes.
std::unique_ptr<rendering::Effect> make_friction_field(std::span<const double> values);
// The true surface stands off the mesh by the field [m], outward, the field taken at the place on the true surface
// (renderers/effects/raised_surface.h).
std::unique_ptr<rendering::Effect> make_height_field_contact(std::span<const double> values);

// What the search for missing effects is to know of them.
rendering::EffectTraits stiffness_field_traits();
rendering::EffectTraits friction_field_traits();

}  // namespace touchstone::renderers
