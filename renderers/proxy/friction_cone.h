// The god-object with friction: the friction cone of Harwin and Melder, EuroHaptics 2002 (cone_friction.h). Parameters
// stiffness_N_per_m, mu_static, mu_dynamic, tip_radius_m. Friction zero is the god-object, bit for bit.
//
// The effect coulomb-friction (effects/friction.h) is the same law on top of a frictionless god-object, its bristle as
// long as presliding_m. On a plane, at constant depth h with presliding_m = mu_static h, both give the same force to
// rounding while the tip moves; a tip that rests while sliding sticks here at once and there when it turns back. Over a
// curved surface, at changing depth and at an edge the effect's force stays tangential to where the frictionless
// god-object is, here the god-object itself lags behind.
#pragma once

#include "harness/rendering/renderer_entry.h"

namespace touchstone::renderers {

rendering::RendererEntry friction_cone_entry();

// For renderers with the cone: mu_static, mu_dynamic, default 0.
std::vector<rendering::ParameterDeclaration> cone_parameters();

}  // namespace touchstone::renderers
