#include "renderers/effects/catalogue.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "harness/rendering/smooth_field.h"
#include "harness/rendering/surface_frame.h"
#include "renderers/effects/adhesion.h"
#include "renderers/effects/engine_effects.h"
#include "renderers/effects/field_effects.h"
#include "renderers/effects/friction.h"
#include "renderers/effects/normal_laws.h"
#include "renderers/effects/surface_texture.h"
#include "renderers/effects/viscous_friction.h"

namespace touchstone::renderers {
using rendering::EffectPhase;
using rendering::EffectTraits;
using rendering::ParameterDeclaration;

namespace {

ParameterDeclaration mu(std::string name, std::string meaning) {
  return {std::move(name), "1", 0.0, 5.0, 0.0, std::move(meaning)};
}

ParameterDeclaration presliding() {
  return {"presliding_m", "m", 1e-12, 1e3, 5e-5, "tangential path from stuck to sliding"};
}

ParameterDeclaration place(std::string name) {
  return {std::move(name), "m", -1e3, 1e3, 0.0, "place in the object's xy plane"};
}

// A hypothesis of what a measurement shows, as most effects are.
EffectEntry with(EffectTraits traits, EffectEntry entry) {
  entry.traits = std::move(traits);
  return entry;
}

// A larger ball hardly fits between two places of the scan; and it meets ever more of the mesh, which is expensive.
EffectTraits tip_radius_traits() {
  EffectTraits traits;
  traits.moves_contact = true;
  traits.along_surface = true;
  traits.plan = [](const rendering::RecordingScales& scales) {
    constexpr double largest = 0.25;
    const double extent_m = scales.extent_m();
    rendering::SearchPlan plan{{{"radius_m", 1.0, 1e-3 * extent_m, largest * extent_m, true}}, {}};
    for (const double share : {0.02, 0.06}) plan.starts.push_back({{"radius_m", share * extent_m}});
    if (scales.surface_is_elsewhere()) {  // as for a registration
      for (const double share : {0.7, 1.5}) plan.starts.push_back({{"radius_m", share * scales.depth_m}});
    }
    return plan;
  };
  return traits;
}

std::vector<EffectEntry> friction_laws() {
  using Phase = EffectPhase;
  return {
      with(coulomb_friction_traits(), {"coulomb-friction",
                                       "dry friction -mu N v_t/|v_t| with pre-sliding",
                                       "Coulomb 1785; Dahl 1968",
                                       "opposes motion; inside Coulomb's cone by construction",
                                       Phase::friction,
                                       false,
                                       {mu("mu_static", "break-away coefficient; mu_dynamic where it is not given"),
                                        mu("mu_dynamic", "sliding coefficient, at most mu_static"), presliding()},
                                       &make_coulomb_friction,
                                       ""}),
      with(stribeck_friction_traits(),
           {"stribeck-friction",
            "friction that falls from mu_static to mu_dynamic with speed",
            "Stribeck 1902; Armstrong-Helouvry et al. 1994, eq 2",
            "opposes motion; inside the cone of mu_static",
            Phase::friction,
            false,
            {mu("mu_static", "coefficient at rest; mu_dynamic where it is not given"),
             mu("mu_dynamic", "coefficient at high speed, at most mu_static"),
             {"stribeck_velocity_m_per_s", "m/s", 1e-9, 1e4, 0.01, "speed at which it has fallen by 63 %"},
             presliding()},
            &make_stribeck_friction,
            ""}),
      with(anisotropic_friction_traits(), {"anisotropic-friction",
                                           "dry friction with coefficients of its own along the object's x and y",
                                           "Goyal, Ruina and Papadopoulos 1991, linear form",
                                           "opposes motion: f . v <= 0 for positive coefficients",
                                           Phase::friction,
                                           false,
                                           {mu("mu_x", "along x"), mu("mu_y", "along y"), presliding()},
                                           &make_anisotropic_friction,
                                           ""}),
      with(sublinear_friction_traits(),
           {"sublinear-friction",
            "dry friction that grows less than the load: mu N_ref (N/N_ref)^exponent",
            "Archard 1957; Adams, Briscoe and Johnson 2007",
            "opposes motion; no cone: the coefficient grows without bound as the load goes",
            Phase::friction,
            false,
            {mu("mu_reference", "coefficient at the reference force"),
             {"exponent", "1", 0.1, 1.0, 1.0, "of the load; 2/3 for a soft ball, 1 is Coulomb's law"},
             {"reference_force_N", "N", 1e-9, 1e6, 1.0, "load at which the coefficient holds"},
             presliding()},
            &make_sublinear_friction,
            ""}),
      with(ageing_friction_traits(),
           {"ageing-friction",
            "dry friction that grows with the age of the contact: mu_fresh + growth ln(1 + age/t_ref)",
            "Dieterich 1979; Ruina 1983 (the ageing law)",
            "opposes motion; inside the cone of the oldest contact",
            Phase::friction,
            false,
            {mu("mu_fresh", "coefficient of a fresh contact"),
             {"growth", "1", 0.0, 1.0, 0.0, "of the coefficient for each e-fold of the age"},
             {"critical_slip_m", "m", 1e-9, 1e3, 1e-3, "path over which a contact is renewed"},
             {"reference_time_s", "s", 1e-9, 1e6, 1e-2, "t_ref, age up to which a contact is fresh"},
             presliding()},
            &make_ageing_friction,
            ""}),
      with(viscous_friction_traits(), {"viscous-friction",
                                       "tangential -b v_t while in contact",
                                       "Newton's law, lumped",
                                       "dissipates b v_t^2",
                                       Phase::friction,
                                       false,
                                       {{"coefficient_N_s_per_m", "N s/m", 0.0, 1e4, 0.0, "b"}},
                                       &make_viscous_friction,
                                       ""}),
  };
}

std::vector<EffectEntry> normal_laws() {
  using Phase = EffectPhase;
  return {
      with(normal_damping_traits(), {"normal-damping",
                                     "N = k d + b d', never below 0",
                                     "Kelvin-Voigt",
                                     "dissipates b d'^2",
                                     Phase::normal_force,
                                     false,
                                     {{"coefficient_N_s_per_m", "N s/m", 0.0, 1e5, 0.0, "b"}},
                                     &make_normal_damping,
                                     ""}),
      with(hunt_crossley_traits(), {"hunt-crossley",
                                    "N = k d + b d d', never below 0",
                                    "Hunt and Crossley 1975",
                                    "dissipates b d d'^2",
                                    Phase::normal_force,
                                    false,
                                    {{"coefficient_N_s_per_m2", "N s/m^2", 0.0, 1e12, 0.0, "b"}},
                                    &make_hunt_crossley,
                                    ""}),
      with(power_law_stiffness_traits(), {"power-law-stiffness",
                                          "N = k d0 (d/d0)^n; n = 1.5 is Hertz",
                                          "Hertz 1882",
                                          "a potential in depth",
                                          Phase::stiffness,
                                          false,
                                          {{"exponent", "1", 0.2, 5.0, 1.0, "n"},
                                           {"reference_depth_m", "m", 1e-9, 1e3, 1e-3, "depth at which k d holds"}},
                                          &make_power_law_stiffness,
                                          ""}),
      with(stiffness_map_traits(),
           {"stiffness-map", "a softer or stiffer place: k (1 + a exp(-r^2/2w^2))", "Gaussian inclusion",
            "a spring at each place; NOT passive sideways: deep from soft to stiff gains, by "
            "the law's lack of a side force",
            Phase::stiffness, false,
            rendering::with_frame({{"amplitude", "1", -0.99, 100.0, 0.0, "a"},
                                   place("x_m"),
                                   place("y_m"),
                                   {"width_m", "m", 1e-9, 1e3, 1e-2, "standard deviation w"}}),
            &make_stiffness_map, ""}),
      with(two_materials_traits(),
           {"two-materials", "another stiffness beyond a straight border: ratio k", "laminate with one joint",
            "a spring at each place; NOT passive sideways: deep from soft to stiff gains, by "
            "the law's lack of a side force",
            Phase::stiffness, false,
            rendering::with_frame({{"ratio", "1", 1e-3, 1e3, 1.0, "stiffness beyond the border over that before it"},
                                   {"direction_rad", "rad", -2.0 * std::numbers::pi, 2.0 * std::numbers::pi, 0.0,
                                    "across the border, from the x axis"},
                                   {"border_m", "m", -1e3, 1e3, 0.0, "its distance from the origin, in that direction"},
                                   {"width_m", "m", 1e-9, 1e3, 1e-3, "over which the stiffness changes, half of it"}}),
            &make_two_materials, ""}),
      with(stress_relaxation_traits(), {"stress-relaxation",
                                        "a second spring ratio*k in series with a damper",
                                        "standard linear solid (Maxwell form)",
                                        "passive as a network of springs and a damper",
                                        Phase::normal_force,
                                        false,
                                        {{"ratio", "1", 0.0, 100.0, 0.0, "second spring over the first"},
                                         {"time_constant_s", "s", 1e-4, 1e4, 0.5, "damper over second spring"}},
                                        &make_stress_relaxation,
                                        ""}),
  };
}

// What changes where contact begins and ends.
std::vector<EffectEntry> shape_laws() {
  using Phase = EffectPhase;
  return {
      with(tip_radius_traits(), {"tip-radius",
                                 "the tip is a ball; positions are its centre",
                                 "Ruspini, Kolarov and Khatib 1997",
                                 "geometry of the base renderer",
                                 Phase::depth,
                                 false,
                                 {{"radius_m", "m", 0.0, 1e3, 0.0, "of the ball"}},
                                 nullptr,
                                 "tip_radius_m"}),
      with(adhesion_traits(), {"adhesion",
                               "once touched, pulls with F exp(-gap/range) until gap > 5 range",
                               "Rose, Ferrante and Smith 1981",
                               "the bond's work is never returned",
                               Phase::adhesion,
                               true,
                               {{"force_N", "N", 0.0, 1e3, 0.0, "F"}, {"range_m", "m", 1e-9, 1e3, 1e-3, "range"}},
                               &make_adhesion,
                               ""}),
      with(surface_texture_traits(),
           {"surface-texture", "sinusoidal height over the object's xy plane", "Minsky 1995",
            "conservative to first order", Phase::depth, true,
            rendering::with_frame(
                {{"amplitude_m", "m", 0.0, 1e3, 0.0, "A"},
                 {"wavelength_m", "m", 1e-9, 1e3, 1e-2, "along the direction"},
                 {"direction_rad", "rad", -2.0 * std::numbers::pi, 2.0 * std::numbers::pi, 0.0, "a, from the x axis"},
                 {"phase_rad", "rad", -2.0 * std::numbers::pi, 2.0 * std::numbers::pi, 0.0, "at the origin"}}),
            &make_surface_texture, ""}),
  };
}

// What differs over the surface in more than one place.
std::vector<EffectEntry> field_laws() {
  using Phase = EffectPhase;
  return {
      with(stiffness_field_traits(),
           {"stiffness-field", "stiffness that differs smoothly over the surface: k exp(f(x, y))",
            "tensor-product B-splines: de Boor 1978; Eilers and Marx 1996",
            "a spring at each place; NOT passive sideways: deep from soft to stiff gains, by the law's lack of a side "
            "force",
            Phase::stiffness, false,
            rendering::field_parameters("1", 3.0, "of f, the logarithm of the stiffness over the renderer's"),
            &make_stiffness_field, ""}),
      with(friction_field_traits(),
           {"friction-field",
            "friction that differs smoothly over the surface: exp(f(x, y)) times that of the effects before it",
            "tensor-product B-splines: de Boor 1978; Eilers and Marx 1996",
            "a positive multiple of a force that opposes motion", Phase::friction, false,
            rendering::field_parameters("1", 3.0, "of f, the logarithm of friction over that of the effects before it"),
            &make_friction_field, ""}),
  };
}

// As engines have them: how a scene is to feel, no hypotheses about a measurement.
std::vector<EffectEntry> engine_laws() {
  using Phase = EffectPhase;
  return {
      {"magnet",
       "off the surface pulls with k gap up to F, then down to zero at a distance",
       "CHAI3D 3.3.0, cEffectMagnet",
       "a potential in the gap",
       Phase::adhesion,
       true,
       {{"force_N", "N", 0.0, 1e3, 0.0, "F, the largest pull"},
        {"distance_m", "m", 1e-9, 1e3, 5e-3, "gap from which nothing pulls"},
        {"inside", "1", 0.0, 1.0, 0.0, "1 (from 0.5 on): pushes out by the same law of the depth, too"}},
       &make_magnet,
       "",
       false},
      {"stick-slip",
       "a spring to the place where the tip stuck last, which slips beyond a force",
       "CHAI3D 3.3.0, cEffectStickSlip",
       "a slip loses what the spring held",
       Phase::adhesion,
       false,
       {{"stiffness_N_per_m", "N/m", 0.0, 1e6, 100.0, "of the spring"},
        {"force_N", "N", 0.0, 1e3, 0.0, "beyond which it slips"}},
       &make_stick_slip,
       "",
       false},
      {"viscosity",
       "-b v while in contact, along the normal too",
       "CHAI3D 3.3.0, cEffectViscosity",
       "dissipates b v^2",
       Phase::adhesion,
       false,
       {{"coefficient_N_s_per_m", "N s/m", 0.0, 1e4, 0.0, "b"}},
       &make_viscosity,
       "",
       false},
      {"height-image",
       "a picture's grey values as heights over the object's xy plane (\"image\": a PGM file)",
       "Minsky 1995; Ho, Basdogan and Srinivasan 1999, section 5",
       "conservative to first order",
       Phase::depth,
       true,
       {{"amplitude_m", "m", 0.0, 1e3, 0.0, "height of white over black"},
        {"pixel_m", "m", 1e-9, 1e3, 1e-3, "side of a pixel"},
        place("x_m"),
        place("y_m")},
       nullptr,
       "",
       false,
       true},
  };
}

std::vector<EffectEntry> make_catalogue() {
  std::vector<EffectEntry> entries = friction_laws();
  for (const auto& laws : {normal_laws(), shape_laws(), field_laws(), engine_laws()})
    entries.insert(entries.end(), laws.begin(), laws.end());
  return entries;
}

}  // namespace

const std::vector<EffectEntry>& contact_effects() {
  static const std::vector<EffectEntry> entries = make_catalogue();
  return entries;
}

const EffectEntry* find_contact_effect(std::string_view name) {
  for (const EffectEntry& entry : contact_effects()) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

}  // namespace touchstone::renderers
