// Laws of the normal force over depth d and its rate d' (positive while loading), on a base of k d:
//   normal-damping        N = k d + b d', never below 0          (Kelvin-Voigt)
//   hunt-crossley         N = k d + b d d', never below 0        (Hunt and Crossley 1975, eq 10 with exponent 1)
//   power-law-stiffness   N = k d0 (d/d0)^n, d0 = reference_depth_m; n = 1.5 is Hertz (1882)
//   stiffness-map         N = k (1 + a exp(-r^2 / 2 w^2)) d, r the distance of the contact point from (x, y) in the
//                         xy plane of the object, or of the map's frame
//   two-materials         N = k ratio^((1 + tanh((s - border) / width)) / 2) d, s = x cos(direction) + y sin(direction)
//                         of the contact point in the same plane: k on one side of a straight border, ratio k beyond
//   stress-relaxation     N = k u + s, s' = ratio k u' - s / time_constant: a second spring of ratio*k in series with a
//                         damper (standard linear solid in Maxwell form), integrated exactly for a u' constant over the
//                         step; the first touch is a step of depth from zero. u is the depth of the surface: the tip's
//                         while it presses; a surface that nothing presses has no mass and hence no force, k u + s = 0,
//                         and comes back by itself with the time constant's (1 + ratio)-fold (Ting 1966, J. Appl. Mech.
//                         33:845, for half spaces: the surface may lag behind a tip that leaves)
// Passivity: the first two dissipate b d'^2 and b d d'^2; the clamp at zero only removes a pull. The next three
// are springs (a potential in d at one place; a map has no force along its gradient, so that a tip pushed in at a soft
// place and drawn out at a stiff one gains energy). The last is passive as a network of spring and damper.
#pragma once

#include <memory>
#include <span>

#include "harness/rendering/effect.h"
#include "harness/rendering/effect_traits.h"

namespace touchstone::renderers {

// Values: coefficient_N_s_per_m.
std::unique_ptr<rendering::Effect> make_normal_damping(std::span<const double> values);
// Values: coefficient_N_s_per_m2.
std::unique_ptr<rendering::Effect> make_hunt_crossley(std::span<const double> values);
// Values: exponent, reference_depth_m.
std::unique_ptr<rendering::Effect> make_power_law_stiffness(std::span<const double> values);
// Values: amplitude, x_m, y_m, width_m, and the frame's.
std::unique_ptr<rendering::Effect> make_stiffness_map(std::span<const double> values);
// Values: ratio, direction_rad, border_m, width_m, and the frame's.
std::unique_ptr<rendering::Effect> make_two_materials(std::span<const double> values);
// Values: ratio, time_constant_s.
std::unique_ptr<rendering::Effect> make_stress_relaxation(std::span<const double> values);

// What the search for missing effects is to know of them.
rendering::EffectTraits normal_damping_traits();
rendering::EffectTraits hunt_crossley_traits();
rendering::EffectTraits power_law_stiffness_traits();
rendering::EffectTraits stiffness_map_traits();
rendering::EffectTraits two_materials_traits();
rendering::EffectTraits stress_relaxation_traits();

}  // namespace touchstone::renderers
