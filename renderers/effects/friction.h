// Dry friction with a memory of the path: the tip drags an imaginary bristle tip over the surface.
//
// Source: the Coulomb law with the pre-sliding of Dahl (1968) in its rate-independent play-operator form: the bristle's
// deflection z follows the tip's tangential displacement and cannot exceed the pre-sliding length s. Stuck, the force
// is f_t = -mu_static N z / s; once |z| reaches s the tip slides with f_t = -mu N z / |z| until it turns back
// (displacement against z), where it sticks again with the force continuous. mu while sliding:
//   coulomb      mu_dynamic
//   stribeck     mu_dynamic + (mu_static - mu_dynamic) exp(-(v/v_s)^2)      (Stribeck 1902; Armstrong-Helouvry 1994)
//   anisotropic  f_t = -N (mu_x z_x, mu_y z_y, sqrt(mu_x mu_y) z_z) / |z|, projected on the tangent plane; x, y are the
//                object's axes
//   sublinear    f_t = -mu_reference N_ref (N / N_ref)^exponent z / |z|: a soft ball's contact grows less than its
//   load,
//                by the power 2/3 in Hertz's contact (1882), and friction with the area that is sheared (Archard 1957,
//                Proc. R. Soc. A 243:190; of skin: Adams, Briscoe and Johnson 2007, Tribol. Lett. 26:239). 1: Coulomb's
//   ageing       the limit of the force is N (mu_fresh + growth ln(1 + age / t_ref)), and a deflection s bears
//                mu_fresh N: a tip that rests may be drawn further before it slides. The age grows with the time and
//                is renewed over the critical slip D, age' = 1 - v age / D, exactly for a v constant over the step
//                (Dieterich 1979, J. Geophys. Res. 84:2161; Ruina 1983, J. Geophys. Res. 88:10359). Sliding steadily
//                the coefficient falls with the logarithm of the speed
// A law of velocity alone would flip its sign with the noise of a held tip; memory of the path does not.
//
// Coulomb's cone holds by construction: |f_t| <= mu_static N, but for the sublinear law, which has none. Passivity: f_t
// opposes z, and z only grows in the direction of motion, so that over a closed path the work on the probe is <= 0 at
// constant N; with N changing while stuck at most mu_static |dN| s / 2 is given back, which the pre-sliding length
// keeps tiny.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "harness/rendering/effect.h"
#include "harness/rendering/effect_traits.h"

namespace touchstone::renderers {

// Friction that is harder to keep going than to start is no friction: it would pull the probe along. Throws BadData
// with `place` (the file and the parameters' place in it) where mu_static < mu_dynamic.
void check_coefficients(double mu_static, double mu_dynamic, const std::string& place);

// Values: mu_static, mu_dynamic, presliding_m.
std::unique_ptr<rendering::Effect> make_coulomb_friction(std::span<const double> values);
// Values: mu_static, mu_dynamic, stribeck_velocity_m_per_s, presliding_m.
std::unique_ptr<rendering::Effect> make_stribeck_friction(std::span<const double> values);
// Values: mu_x, mu_y, presliding_m.
std::unique_ptr<rendering::Effect> make_anisotropic_friction(std::span<const double> values);
// Values: mu_fresh, growth, critical_slip_m, reference_time_s, presliding_m.
std::unique_ptr<rendering::Effect> make_ageing_friction(std::span<const double> values);
// Values: mu_reference, exponent, reference_force_N, presliding_m.
std::unique_ptr<rendering::Effect> make_sublinear_friction(std::span<const double> values);

// What the search for missing effects is to know of them.
rendering::EffectTraits coulomb_friction_traits();
rendering::EffectTraits stribeck_friction_traits();
rendering::EffectTraits anisotropic_friction_traits();
rendering::EffectTraits sublinear_friction_traits();
rendering::EffectTraits ageing_friction_traits();

}  // namespace touchstone::renderers
