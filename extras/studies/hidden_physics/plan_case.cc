// What each blind case hides, and at which place, scale and noise.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "harness/base/error.h"
#include "hidden_physics/blind_case.h"
#include "hidden_physics/hide_effect.h"

namespace touchstone::hidden_physics {
namespace {

const std::vector<std::string> sets{"one",     "one-noisy",   "two",       "three",     "none",
                                    "unknown", "cannot-tell", "corrupted", "full-band", "outside"};

class Planner {
 public:
  Planner(BlindCase& plan, Random random) : plan_(plan), random_(random) {}

  void ground(const std::string& set, std::size_t index) {
    HiddenPhysics& physics = plan_.physics;
    physics.stiffness_N_per_m = random_.log_uniform(250.0, 2000.0);
    sizes_.force_N = random_.uniform(2.5, 4.5);
    sizes_.depth_m = std::min(sizes_.force_N / physics.stiffness_N_per_m, 0.014);
    sizes_.force_N = sizes_.depth_m * physics.stiffness_N_per_m;
    sizes_.half_side_m = sizes_.depth_m * random_.uniform(6.5, 10.0);
    sizes_.sliding_m_per_s = 0.6 * sizes_.half_side_m / 0.7;
    sizes_.pressing_m_per_s = sizes_.depth_m / 0.35;
    plan_.nominal_stiffness_N_per_m = std::round(100.0 * physics.stiffness_N_per_m * random_.uniform(0.9, 1.1)) / 100.0;
    plan_.train.half_side_m = plan_.holdout.half_side_m = sizes_.half_side_m;
    plan_.train.depth_m = plan_.holdout.depth_m = sizes_.depth_m;
    plan_.holdout.pace = random_.uniform(0.75, 1.35);
    plan_.holdout.load = random_.uniform(0.75, 0.95);
    physics.presliding_m = random_.uniform(1e-5, 3e-5) * std::min(1.0, sizes_.depth_m / 0.004);
    physics.reference_depth_m = sizes_.depth_m;
    // Noise: low, middle, high; finer on small objects, as one would choose the tracker.
    const std::size_t level = set == "one-noisy" ? 2 : set == "full-band" ? (index / 3) % 3 : index % 2;
    DeclaredInstrument& d = plan_.declared;
    d.force_noise_N = std::array{0.01, 0.02, 0.04}[level];
    d.position_noise_m =
        std::min(std::array{5e-5, 1.5e-4, 3e-4}[level], std::array{0.0125, 0.0375, 0.06}[level] * sizes_.depth_m);
  }

  void shape(bool flat) {
    TrueSurface& surface = plan_.truth;
    surface.half_side_m = 1.35 * sizes_.half_side_m;
    plan_.cells = flat ? 10 : 64;
    if (flat) return;
    const double L = sizes_.half_side_m;
    // Radii of curvature stay well above the depth.
    const double bend = 1.0 / (6.0 * sizes_.depth_m + 1.5 * L);
    switch (random_.below(3)) {
      case 0:
        surface.curvature_per_m = Vec2(-bend * random_.uniform(0.4, 1.0), -bend * random_.uniform(0.4, 1.0));
        break;
      case 1:
        surface.curvature_per_m = Vec2(bend * random_.uniform(0.3, 0.8), -bend * random_.uniform(0.3, 0.8));
        break;
      default:
        for (int w = 0; w < 3; ++w) {
          const double k = 2.0 * std::numbers::pi / (L * random_.uniform(1.2, 2.5));
          const double angle = random_.uniform(0.0, 2.0 * std::numbers::pi);
          surface.waves.push_back({0.35 * bend / (k * k), k * Vec2(std::cos(angle), std::sin(angle)),
                                   random_.uniform(0.0, 2.0 * std::numbers::pi)});
        }
    }
  }

  // Hides one effect by its name in model files.
  void hide(const std::string& name) {
    if (const auto bump = hide_effect(plan_, sizes_, random_, name)) hidden_bump_ = bump;
  }

  static const std::vector<std::string>& hideable() {
    static const std::vector<std::string> names{
        "coulomb-friction",     "tool-weight",       "stress-relaxation", "force-bias",      "tip-radius",
        "normal-damping",       "time-lag",          "surface-texture",   "force-crosstalk", "stribeck-friction",
        "stiffness-map",        "force-saturation",  "viscous-friction",  "registration",    "power-law-stiffness",
        "force-drift",          "adhesion",          "surface-geometry",  "hunt-crossley",   "tool-inertia",
        "anisotropic-friction", "sublinear-friction"};
    return names;
  }

  // Effects that need a curved surface to be told from a shift of the mesh.
  static bool wants_curvature(const std::string& name) { return name == "tip-radius" || name == "registration"; }

  // Something that no library of ours has.
  void hide_unknown(std::size_t kind) {
    HiddenPhysics& h = plan_.physics;
    const double F = sizes_.force_N;
    const double D = sizes_.depth_m;
    const double L = sizes_.half_side_m;
    Random& r = random_;
    switch (kind % 8) {
      case 0: {
        const double mu = r.uniform(0.4, 0.7);
        h.mu_static = Vec2(mu, mu);
        h.mu_dynamic = 0.6 * h.mu_static;
        h.tool_spring_N_per_m = mu * F / (0.25 * L);
        return note("stick-slip", "unknown", {{"mu", mu}, {"stiffness_N_per_m", h.tool_spring_N_per_m}});
      }
      case 1:
        h.bottom_depth_m = 0.5 * D;
        h.bottom_stiffness_N_per_m = 3.0 * h.stiffness_N_per_m;
        return note("second-layer", "unknown",
                    {{"depth_m", h.bottom_depth_m}, {"stiffness_N_per_m", h.bottom_stiffness_N_per_m}});
      case 2:
        h.drag_N_s_per_m = 0.25 * F / sizes_.sliding_m_per_s;
        return note("drag", "unknown", {{"coefficient_N_s_per_m", h.drag_N_s_per_m}});
      case 3:
        h.vibration_N = 0.12 * F;
        h.vibration_Hz = r.uniform(5.0, 12.0);
        return note("vibration", "unknown", {{"force_N", h.vibration_N}, {"frequency_Hz", h.vibration_Hz}});
      case 4:
        h.dent_share = 0.45;
        return note("dent", "unknown", {{"share", h.dent_share}});
      case 5:
        h.softening_share = 0.5;
        h.softening_time_s = r.uniform(4.0, 8.0);
        return note("softening", "unknown", {{"share", h.softening_share}, {"time_constant_s", h.softening_time_s}});
      case 6:
        h.cable_N_per_m = 0.25 * F / L;
        h.cable_end_W_m = L * Vec3(r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0), 0.5);
        return note("cable", "unknown", {{"stiffness_N_per_m", h.cable_N_per_m}});
      default:
        h.magnet_N = 0.25 * F;
        h.magnet_range_m = 0.8 * D;
        return note("magnet", "unknown", {{"force_N", h.magnet_N}, {"range_m", h.magnet_range_m}});
    }
  }

  // Something for which a law is to be found; families take turns. As strong as an unknown effect is.
  void hide_outside(std::size_t kind) {
    OutsidePhysics& h = plan_.physics.outside;
    const double F = sizes_.force_N;
    const double D = sizes_.depth_m;
    const double L = sizes_.half_side_m;
    Random& r = random_;
    const auto tell = [&](const char* name, std::vector<std::string> follows, std::map<std::string, double> values) {
      plan_.follows = std::move(follows);
      note(name, "unknown", std::move(values));
    };
    switch (kind % 7) {
      case 0: {
        h.cogging_N = F * r.uniform(0.1, 0.2);
        h.cogging_length_m = L * r.uniform(0.25, 0.7);
        h.cogging_phase_rad = r.uniform(0.0, 2.0 * std::numbers::pi);
        const double azimuth = r.uniform(0.0, 2.0 * std::numbers::pi);
        const double rise = r.uniform(0.1, 0.6);
        h.cogging_along_W =
            Vec3(std::cos(rise) * std::cos(azimuth), std::cos(rise) * std::sin(azimuth), std::sin(rise));
        return tell("cogging", {"place"}, {{"force_N", h.cogging_N}, {"length_m", h.cogging_length_m}});
      }
      case 1:
        h.hysteresis_N = F * r.uniform(0.15, 0.3);
        h.hysteresis_m = L * r.uniform(0.08, 0.25);
        return tell("hysteresis", {"past of the motion"}, {{"force_N", h.hysteresis_N}, {"path_m", h.hysteresis_m}});
      case 2:
        h.bending_N_per_m = plan_.physics.stiffness_N_per_m * r.uniform(0.15, 0.4);
        return tell("bending", {"slope of the surface", "load", "place"}, {{"stiffness_N_per_m", h.bending_N_per_m}});
      case 3:
        h.warming_N = F * 0.3 * Vec3(r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0), r.uniform(0.5, 1.0));
        h.warming_s = r.uniform(1.5, 4.0);
        return tell("warming", {"time"}, {{"force_N", h.warming_N.norm()}, {"time_constant_s", h.warming_s}});
      case 4: {
        const double azimuth = r.uniform(0.0, 2.0 * std::numbers::pi);
        h.leash_end_W_m = L * Vec3(std::cos(azimuth), std::sin(azimuth), 0.8);
        h.leash_m = L * r.uniform(1.0, 1.3);
        h.leash_N_per_m = F * r.uniform(0.4, 0.8) / L;
        return tell("leash", {"place"}, {{"stiffness_N_per_m", h.leash_N_per_m}, {"slack_m", h.leash_m}});
      }
      case 5:
        h.tissue_from_m = D * r.uniform(0.35, 0.6);
        h.tissue_N = F * r.uniform(1.0, 2.0);
        return tell("tissue", {"depth"}, {{"from_m", h.tissue_from_m}, {"force_N", h.tissue_N}});
      default:
        h.play_m = D * r.uniform(0.05, 0.12);
        return tell("backlash", {"past of the motion"}, {{"play_m", h.play_m}});
    }
  }

  // Something above the band of means over the tracker's samples; kinds and then noise levels take turns. From what a
  // hand just notices (7 % of the force: Jones 1989) to twice that.
  void shake(std::size_t kind) {
    HiddenShaking& s = plan_.shaking;
    Random& r = random_;
    const double size_N = sizes_.force_N * r.uniform(0.07, 0.14);
    const double azimuth = r.uniform(0.0, 2.0 * std::numbers::pi);
    const double height = r.uniform(-1.0, 1.0);
    const double flat = std::sqrt(1.0 - height * height);
    s.along_S = Vec3(flat * std::cos(azimuth), flat * std::sin(azimuth), height);
    switch (kind % 3) {
      case 0:
        s.hum_N = size_N;
        s.hum_Hz = (r.uniform() < 0.5 ? 50.0 : 60.0) * r.uniform(0.999, 1.001);  // mains in ordinary hours
        s.hum_second = r.uniform(0.0, 0.3);
        s.hum_phase_rad = r.uniform(0.0, 2.0 * std::numbers::pi);
        return note("hum", "unknown", {{"force_N", s.hum_N}, {"frequency_Hz", s.hum_Hz}});
      case 1:
        s.buzz_N = size_N;
        s.buzz_Hz = r.uniform(30.0, 115.0);
        s.buzz_from_m_per_s = 0.3 * sizes_.sliding_m_per_s;
        s.buzz_load_N = sizes_.force_N;
        return note("buzz", "unknown", {{"force_N", s.buzz_N}, {"frequency_Hz", s.buzz_Hz}});
      default:
        s.ringing_N = size_N / std::numbers::sqrt2;
        s.ringing_Hz = r.uniform(30.0, 115.0);
        s.ringing_damping = r.log_uniform(0.005, 0.03);
        return note("resonance", "unknown",
                    {{"force_N", s.ringing_N}, {"frequency_Hz", s.ringing_Hz}, {"damping", s.ringing_damping}});
    }
  }

  // Once everything is hidden: the mesh, which lacks a hidden bump, and what may be said of its error.
  void finish(bool mesh_error) {
    plan_.meshed = plan_.truth;
    TrueSurface known = plan_.truth;
    if (mesh_error) {
      const double L = sizes_.half_side_m;
      const double size = sizes_.depth_m * random_.uniform(0.01, 0.03);
      for (int b = 0; b < 4; ++b) {
        plan_.meshed.bumps.push_back({random_.uniform() < 0.5 ? -size : size,
                                      L * Vec2(random_.uniform(-0.6, 0.6), random_.uniform(-0.6, 0.6)),
                                      L * random_.uniform(0.15, 0.4)});
      }
      plan_.cells = 64;
    }
    const double deviation = known.deviation_m(plan_.meshed, plan_.cells);
    plan_.declared.geometry_error_m = 1e-6 * std::ceil(1e6 * std::max(deviation, 4e-3 * sizes_.depth_m));
    if (hidden_bump_) plan_.truth.bumps.push_back(*hidden_bump_);
  }

  void cannot_tell(std::size_t kind) {
    switch (kind % 3) {
      case 0:
        shape(random_.uniform() < 0.5);
        plan_.train.style = plan_.holdout.style = ScriptStyle::upright;
        hide(kind % 2 == 0 ? "tool-weight" : "force-bias");
        if (kind % 2 == 1) {  // along the vertical alone
          const double fz = plan_.instrument.bias_S_N.z();
          plan_.instrument.bias_S_N = Vec3(0.0, 0.0, -std::abs(fz));
          plan_.effects.back().parameters = {{"fx_N", 0.0}, {"fy_N", 0.0}, {"fz_N", -std::abs(fz)}};
        }
        plan_.ambiguous = {"tool-weight", "force-bias"};
        return;
      case 1:
        shape(true);
        plan_.train.style = plan_.holdout.style = ScriptStyle::one_speed;
        plan_.train.circle_m_per_s = plan_.holdout.circle_m_per_s = 0.5 * sizes_.sliding_m_per_s;
        plan_.holdout.load = 1.0;
        hide(kind % 2 == 0 ? "viscous-friction" : "coulomb-friction");
        plan_.ambiguous = {"coulomb-friction", "viscous-friction"};
        return;
      default:
        shape(true);
        hide("tip-radius");
        plan_.ambiguous = {"tip-radius", "registration"};
    }
  }

  void note(const std::string& name, const std::string& side, std::map<std::string, double> parameters) {
    plan_.effects.push_back({name, side, std::move(parameters)});
  }

 private:
  BlindCase& plan_;
  Random random_;
  CaseSizes sizes_;
  std::optional<TrueSurface::Bump> hidden_bump_;
};

std::string opaque_name(Random random) {
  constexpr std::string_view letters = "abcdefghjkmnpqrstuvwxyz23456789";
  std::string name;
  for (int i = 0; i < 8; ++i) name += letters[random.below(letters.size())];
  return name;
}

// Pairs and triples that take turns; none contains two laws of the same kind.
std::vector<std::string> several(std::size_t count, std::size_t index, Random& random) {
  static const std::vector<std::vector<std::string>> kinds{
      {"coulomb-friction", "viscous-friction", "anisotropic-friction", "stribeck-friction"},
      {"tool-weight", "force-bias", "force-crosstalk", "force-drift", "time-lag", "force-saturation"},
      {"stress-relaxation", "normal-damping", "power-law-stiffness", "hunt-crossley", "stiffness-map", "adhesion"},
      {"tip-radius", "surface-geometry", "registration", "surface-texture"}};
  std::vector<std::string> names;
  for (std::size_t k = 0; k < count; ++k) {
    const auto& kind = kinds[(index + k) % kinds.size()];
    names.push_back(kind[random.below(kind.size())]);
  }
  return names;
}

}  // namespace

const std::vector<std::string>& blind_sets() { return sets; }

BlindCase plan_case(const std::string& set, std::size_t index, std::uint64_t seed) {
  const auto known = std::find(sets.begin(), sets.end(), set);
  if (known == sets.end()) throw UsageError("unknown set '" + set + "'");
  const Random root = Random(seed).stream(1000 * static_cast<std::uint64_t>(known - sets.begin())).stream(index);
  BlindCase plan;
  plan.set = set;
  plan.id = opaque_name(root.stream(0));
  plan.seed = root.stream(1).stream(0).next_u64();
  plan.verdict = "explained";
  Random random = root.stream(2);
  Planner planner(plan, root.stream(3));
  planner.ground(set, index);
  bool mesh_error = false;
  if (set == "one" || set == "one-noisy" || set == "two" || set == "three") {
    const std::size_t count = set == "two" ? 2 : set == "three" ? 3 : 1;
    const auto names = count == 1 ? std::vector{Planner::hideable()[index % Planner::hideable().size()]}
                                  : several(count, index, random);
    const bool curved = std::any_of(names.begin(), names.end(), Planner::wants_curvature);
    planner.shape(!curved && random.uniform() < 0.35);
    for (const auto& name : names) planner.hide(name);
  } else if (set == "none") {
    mesh_error = index % 2 == 1;
    planner.shape(random.uniform() < 0.35);
    plan.verdict = "consistent";
  } else if (set == "unknown") {
    planner.shape(random.uniform() < 0.35);
    planner.hide_unknown(index);
    plan.verdict = "unexplained";
  } else if (set == "outside") {
    // What leans needs a slope to show.
    planner.shape(index % 7 != 2 && random.uniform() < 0.35);
    planner.hide_outside(index);
    plan.verdict = "unexplained";
  } else if (set == "full-band") {
    planner.shape(random.uniform() < 0.35);
    planner.shake(index);
    plan.verdict = "unexplained";
  } else if (set == "cannot-tell") {
    planner.cannot_tell(index);
    plan.verdict = "not-identifiable";
  } else {
    planner.shape(random.uniform() < 0.35);
    plan.verdict = "unexplained";
    plan.corruption =
        std::array{Corruption::shuffled_blocks, Corruption::negative_friction, Corruption::negative_mass}[index % 3];
    if (plan.corruption == Corruption::negative_friction) planner.hide("coulomb-friction");
    if (plan.corruption == Corruption::negative_mass) {
      planner.hide("tool-weight");
      plan.instrument.weight_kg *= -1.0;
    }
    plan.effects.clear();
  }
  planner.finish(mesh_error);
  return plan;
}

}  // namespace touchstone::hidden_physics
