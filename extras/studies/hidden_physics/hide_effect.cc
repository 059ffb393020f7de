#include "hidden_physics/hide_effect.h"

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <stdexcept>

namespace touchstone::hidden_physics {
namespace {

class Hider {
 public:
  Hider(BlindCase& plan, const CaseSizes& sizes, Random& random) : plan_(plan), sizes_(sizes), random_(random) {}

  // Hides one effect by its name in model files.
  void hide(const std::string& name) {
    const bool known = hide_friction(name) || hide_contact(name) || hide_force_reading(name) || hide_place(name);
    if (!known) throw std::logic_error("no physics is written for the effect " + name);
  }

  [[nodiscard]] const std::optional<TrueSurface::Bump>& bump() const { return hidden_bump_; }

 private:
  // Each of these knows some of the effects, and says whether the name is one of them. Friction laws:
  bool hide_friction(const std::string& name) {
    HiddenPhysics& h = plan_.physics;
    const double F = sizes_.force_N;
    Random& r = random_;
    const Ways ways{
        {"coulomb-friction",
         [&] {
           const double mu = r.uniform(0.12, 0.6);
           h.mu_static = h.mu_dynamic = Vec2(mu, mu);
           note(name, "contact", {{"mu_static", mu}, {"mu_dynamic", mu}});
         }},
        {"stribeck-friction",
         [&] {
           const double high = r.uniform(0.4, 0.8);
           const double low = high * r.uniform(0.25, 0.5);
           h.stribeck_velocity_m_per_s = sizes_.sliding_m_per_s * r.log_uniform(0.15, 0.6);
           h.mu_static = Vec2(high, high);
           h.mu_dynamic = Vec2(low, low);
           note(name, "contact",
                {{"mu_static", high}, {"mu_dynamic", low}, {"stribeck_velocity_m_per_s", h.stribeck_velocity_m_per_s}});
         }},
        {"anisotropic-friction",
         [&] {
           h.mu_dynamic = Vec2(r.uniform(0.1, 0.25), r.uniform(0.4, 0.65));
           if (r.uniform() < 0.5) std::swap(h.mu_dynamic.x(), h.mu_dynamic.y());
           h.mu_static = h.mu_dynamic;
           note(name, "contact", {{"mu_x", h.mu_dynamic.x()}, {"mu_y", h.mu_dynamic.y()}});
         }},
        {"sublinear-friction",
         [&] {
           h.ball_radius_m = r.uniform(2e-3, 8e-3);
           h.elastic_modulus_Pa = r.log_uniform(1e5, 1e6);
           const double load_N = 0.5 * F;
           const double mu = r.uniform(0.25, 0.7);
           const double radius_m = std::cbrt(0.75 * h.ball_radius_m * load_N / h.elastic_modulus_Pa);
           h.shear_strength_Pa = mu * load_N / (std::numbers::pi * radius_m * radius_m);
           note(name, "contact", {{"mu_reference", mu}, {"exponent", 2.0 / 3.0}, {"reference_force_N", load_N}});
         }},
        {"viscous-friction",
         [&] {
           h.viscous_N_s_per_m = r.uniform(0.1, 0.4) * F / sizes_.sliding_m_per_s;
           note(name, "contact", {{"coefficient_N_s_per_m", h.viscous_N_s_per_m}});
         }},
    };
    return run(ways, name);
  }

  // What else acts in the contact.
  bool hide_contact(const std::string& name) {
    HiddenPhysics& h = plan_.physics;
    const double F = sizes_.force_N;
    const double D = sizes_.depth_m;
    const double L = sizes_.half_side_m;
    Random& r = random_;
    const Ways ways{
        {"normal-damping",
         [&] {
           h.damping_N_s_per_m = r.uniform(0.08, 0.3) * F / sizes_.pressing_m_per_s;
           note(name, "contact", {{"coefficient_N_s_per_m", h.damping_N_s_per_m}});
         }},
        {"hunt-crossley",
         [&] {
           h.hunt_crossley_N_s_per_m2 = r.uniform(0.15, 0.5) * F / (sizes_.pressing_m_per_s * D);
           note(name, "contact", {{"coefficient_N_s_per_m2", h.hunt_crossley_N_s_per_m2}});
         }},
        {"power-law-stiffness",
         [&] {
           h.exponent = r.uniform() < 0.75 ? r.uniform(1.3, 2.2) : r.uniform(0.55, 0.8);
           note(name, "contact", {{"exponent", h.exponent}, {"reference_depth_m", h.reference_depth_m}});
         }},
        {"stiffness-map",
         [&] {
           h.map_amplitude = r.uniform() < 0.7 ? r.uniform(0.4, 1.5) : -r.uniform(0.3, 0.7);
           h.map_place_m = some_place();
           h.map_width_m = L * r.uniform(0.15, 0.4);
           note(name, "contact",
                {{"amplitude", h.map_amplitude},
                 {"x_m", h.map_place_m.x()},
                 {"y_m", h.map_place_m.y()},
                 {"width_m", h.map_width_m}});
         }},
        {"stress-relaxation",
         [&] {
           h.relaxation_ratio = r.uniform(0.25, 1.0);
           h.relaxation_time_s = r.log_uniform(0.1, 1.2);
           note(name, "contact", {{"ratio", h.relaxation_ratio}, {"time_constant_s", h.relaxation_time_s}});
         }},
        {"tip-radius",
         [&] {
           h.tip_radius_m = D * r.uniform(0.6, 1.6);
           note(name, "contact", {{"radius_m", h.tip_radius_m}});
         }},
        {"adhesion",
         [&] {
           h.adhesion_N = F * r.uniform(0.08, 0.25);
           h.adhesion_range_m = D * r.uniform(0.05, 0.25);
           note(name, "contact", {{"force_N", h.adhesion_N}, {"range_m", h.adhesion_range_m}});
         }},
        {"surface-texture",
         [&] {
           h.texture_amplitude_m = D * r.uniform(0.06, 0.12);
           h.texture_wavelength_m = L * r.uniform(0.1, 0.35);
           h.texture_direction_rad = r.uniform(0.0, std::numbers::pi);
           h.texture_phase_rad = r.uniform(0.0, 2.0 * std::numbers::pi);
           note(name, "contact",
                {{"amplitude_m", h.texture_amplitude_m},
                 {"wavelength_m", h.texture_wavelength_m},
                 {"direction_rad", h.texture_direction_rad},
                 {"phase_rad", h.texture_phase_rad}});
         }},
    };
    return run(ways, name);
  }

  // What the force sensor adds to what acts on the tip, or takes away.
  bool hide_force_reading(const std::string& name) {
    HiddenInstrument& i = plan_.instrument;
    const double F = sizes_.force_N;
    const double L = sizes_.half_side_m;
    Random& r = random_;
    const Ways ways{
        {"tool-weight",
         [&] {
           i.weight_kg = F * r.uniform(0.1, 0.4) / 9.8;
           note(name, "instrument", {{"mass_kg", i.weight_kg}});
         }},
        {"tool-inertia",
         [&] {
           i.inertia_kg = r.uniform(0.08, 0.3) * std::max(1.0, 0.05 / L);
           note(name, "instrument", {{"mass_kg", i.inertia_kg}});
         }},
        {"force-bias",
         [&] {
           i.bias_S_N = F * 0.15 *
                        Vec3(sign() * r.uniform(0.2, 1.0), sign() * r.uniform(0.2, 1.0), sign() * r.uniform(0.2, 1.0));
           note(name, "instrument", {{"fx_N", i.bias_S_N.x()}, {"fy_N", i.bias_S_N.y()}, {"fz_N", i.bias_S_N.z()}});
         }},
        {"force-drift",
         [&] {
           i.drift_S_N_per_s =
               0.015 * F *
               Vec3(sign() * r.uniform(0.3, 1.0), sign() * r.uniform(0.3, 1.0), sign() * r.uniform(0.3, 1.0));
           note(name, "instrument",
                {{"fx_N_per_s", i.drift_S_N_per_s.x()},
                 {"fy_N_per_s", i.drift_S_N_per_s.y()},
                 {"fz_N_per_s", i.drift_S_N_per_s.z()}});
         }},
        {"force-crosstalk",
         [&] {
           i.c_xz = sign() * r.uniform(0.05, 0.16);
           i.c_yz = sign() * r.uniform(0.05, 0.16);
           note(name, "instrument", {{"c_xz", i.c_xz}, {"c_yz", i.c_yz}});
         }},
        {"force-saturation",
         [&] {
           i.limit_N = F * r.uniform(0.45, 0.65);
           note(name, "instrument", {{"limit_N", i.limit_N}});
         }},
    };
    return run(ways, name);
  }

  // When and where the tip was measured, and on which surface.
  bool hide_place(const std::string& name) {
    HiddenInstrument& i = plan_.instrument;
    const double D = sizes_.depth_m;
    const double L = sizes_.half_side_m;
    Random& r = random_;
    const Ways ways{
        {"time-lag",
         [&] {
           i.lag_s = r.uniform(0.012, 0.05);
           note(name, "instrument", {{"lag_s", i.lag_s}});
         }},
        {"registration",
         [&] {
           i.shift_W_m =
               D * Vec3(sign() * r.uniform(0.1, 0.4), sign() * r.uniform(0.1, 0.4), sign() * r.uniform(0.06, 0.2));
           i.turn_rad = Vec3(r.uniform(-0.02, 0.02), r.uniform(-0.02, 0.02), 0.0);
           note(name, "instrument",
                {{"dx_m", i.shift_W_m.x()},
                 {"dy_m", i.shift_W_m.y()},
                 {"dz_m", i.shift_W_m.z()},
                 {"rx_rad", i.turn_rad.x()},
                 {"ry_rad", i.turn_rad.y()}});
         }},
        {"surface-geometry",
         [&] {
           const TrueSurface::Bump bump{sign() * D * r.uniform(0.12, 0.35), some_place(), L * r.uniform(0.15, 0.35)};
           hidden_bump_ = bump;
           note(name, "instrument",
                {{"amplitude_m", bump.amplitude_m},
                 {"x_m", bump.centre_m.x()},
                 {"y_m", bump.centre_m.y()},
                 {"width_m", bump.width_m}});
         }},
    };
    return run(ways, name);
  }

  using Ways = std::map<std::string, std::function<void()>>;

  static bool run(const Ways& ways, const std::string& name) {
    const auto way = ways.find(name);
    if (way != ways.end()) way->second();
    return way != ways.end();
  }

  double sign() { return random_.uniform() < 0.5 ? -1.0 : 1.0; }
  Vec2 some_place() {
    const double L = sizes_.half_side_m;
    return Vec2(L * random_.uniform(-0.4, 0.4), L * random_.uniform(-0.4, 0.4));
  }

  void note(const std::string& name, const std::string& side, std::map<std::string, double> parameters) {
    plan_.effects.push_back({name, side, std::move(parameters)});
  }

  BlindCase& plan_;
  const CaseSizes& sizes_;
  Random& random_;
  std::optional<TrueSurface::Bump> hidden_bump_;
};

}  // namespace

std::optional<TrueSurface::Bump> hide_effect(BlindCase& plan, const CaseSizes& sizes, Random& random,
                                             const std::string& name) {
  Hider hider(plan, sizes, random);
  hider.hide(name);
  return hider.bump();
}

}  // namespace touchstone::hidden_physics
