#include "servo/atlas.h"

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/surface/embree_surface.h"
#include "servo/flat_wall.h"

namespace touchstone::servo {
namespace {

constexpr double half_way_m = 0.012;
constexpr double speed_m_per_s = 0.016;
constexpr double above_m = 2e-3;
constexpr double down_s = 0.3;
constexpr double hold_s = 0.4;
constexpr double press_N = 1.0;
constexpr std::size_t triangle_count = 10000;
constexpr std::size_t few_triangles = 200;  // of the passive plane, a test of any renderer, also of a slow one

double top_m(const surface::Surface& shape, double x_m) {
  const Box3 box = shape.bounds();
  const double margin_m = box.sizes().norm();
  const auto hit =
      shape.first_crossing(Vec3(x_m, 1e-4, box.max().z() + margin_m), Vec3(x_m, 1e-4, box.min().z() - margin_m));
  if (!hit) throw UsageError("the atlas's path leaves the shape");
  return hit->p_W_m.z();
}

}  // namespace

const std::vector<AtlasCase>& atlas_cases() {
  static const std::vector<AtlasCase> cases{
      {"passive plane", "plane", {}, 0.0, true},
      {"plane", "plane", {}, 0.0},
      {"plane, friction 0.4", "plane", {}, 0.4},
      {"ball of 30 mm", "sphere", {}, 0.0},
      {"ridge", "extrusion", {}, 0.0},
      {"step of 1 mm", "step", {{"height_m", 1e-3}}, 0.0},
      {"v-groove", "v-groove", {{"depth_m", 3e-3}, {"opening_rad", 2.0}}, 0.0},
      {"crease of 0.2 rad", "crease", {{"bend_rad", -0.2}}, 0.0},
      {"shell of 2 mm", "thin-shell", {{"thickness_m", 2e-3}}, 0.0},
  };
  return cases;
}

MotionColumns atlas_path(const surface::Surface& shape, const LoopParameters& parameters) {
  const double stiffness = parameters.axis.hand_stiffness_N_per_m;
  if (!(stiffness > 0.0))
    throw UsageError("a hand without stiffness presses on nothing: hand_stiffness_N_per_m above 0");
  const double deep_m = press_N / stiffness;
  MotionColumns path;
  const double slide_s = 2.0 * half_way_m / speed_m_per_s;
  const double whole_s = down_s + hold_s + slide_s + hold_s;
  for (double t = 0.0; t < whole_s; t += 1e-3) {
    const double along = std::clamp((t - down_s - hold_s) / slide_s, 0.0, 1.0);
    const double x_m = -half_way_m + 2.0 * half_way_m * along;
    const double down = std::min(1.0, t / down_s);
    path.t_s.push_back(t);
    path.p_W_m.emplace_back(x_m, 1e-4, top_m(shape, x_m) + above_m - down * (above_m + deep_m));
  }
  return path;
}

rendering::Model atlas_model(const rendering::RendererEntry& entry, double stiffness_N_per_m) {
  rendering::Model model;
  model.renderer = entry.name;
  model.source = "the atlas";
  const bool has_spring = std::ranges::any_of(
      entry.parameters, [](const auto& parameter) { return parameter.name == "stiffness_N_per_m"; });
  if (has_spring) model.parameters["stiffness_N_per_m"] = stiffness_N_per_m;
  return model;
}

namespace {

// A device without quantisation, dry friction, latency and limits, with viscous friction b = K T / 2 / share.
LoopSetup passive_setup(LoopSetup setup, double stiffness_N_per_m) {
  constexpr double share_of_limit = 0.8;
  constexpr double device_mass_kg = 0.1;
  const LoopParameters& asked = setup.parameters;
  LoopParameters own;
  own.axis = asked.axis;
  own.axis.friction_N = own.axis.actuator_time_constant_s = 0.0;
  own.axis.damping_N_s_per_m = 0.5 * stiffness_N_per_m * asked.period_s / share_of_limit;
  own.hand_mass_kg = asked.hand_mass_kg;
  own.period_s = asked.period_s;
  setup.parameters = own;
  setup.device_masses_kg = {device_mass_kg};
  return setup;
}

// What the exact wall does on an ideal servo is right there: what the renderer shakes by itself counts, too.
Judgement beside_exact_wall(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& own,
                            double stiffness_N_per_m, double top_m, const perception::Thresholds& thresholds) {
  LoopRuns runs = run_for_judgement(renderer, path, own);
  FlatWall wall(stiffness_N_per_m, top_m);
  if (!runs.too_slow) runs.ideal = run_ideal_loop(wall, path, own);
  return judge(runs, thresholds);
}

// Of a renderer whose tip is a ball unless it is told otherwise.
double tip_radius_m(const rendering::RendererEntry& entry) {
  const auto radius = std::ranges::find(entry.parameters, "tip_radius_m", &rendering::ParameterDeclaration::name);
  return radius == entry.parameters.end() ? 0.0 : radius->initial;
}

bool felt(const AtlasAnswer& answer) {
  return answer.verdict == Verdict::buzzes || answer.verdict == Verdict::unstable;
}

}  // namespace

AtlasAnswer atlas_answer(const rendering::Catalogue& catalogue, const rendering::Generators& generators,
                         rendering::Model model, const AtlasCase& where, const LoopSetup& asked,
                         const perception::Thresholds& thresholds) {
  AtlasAnswer out;
  out.renderer = model.renderer;
  out.where = where.name;
  const auto stiffness = model.parameters.find("stiffness_N_per_m");
  if (where.passive && stiffness == model.parameters.end()) {
    out.refused = "it has no parameter stiffness_N_per_m";
    return out;
  }
  const LoopSetup setup = where.passive ? passive_setup(asked, stiffness->second) : asked;
  if (where.friction > 0.0) {
    rendering::NamedParameters friction;
    friction.name = "coulomb-friction";
    friction.parameters = {{"mu_static", where.friction}, {"mu_dynamic", where.friction}};
    model.effects.push_back(friction);
  }
  const double radius_m = tip_radius_m(catalogue.find(model));
  MotionColumns path = atlas_path(*generators.surface(where.surface, where.parameters), setup.parameters);
  for (Vec3& meant_W_m : path.p_W_m) meant_W_m.z() += radius_m;
  const auto mesh =
      generators.mesh(where.surface, where.parameters, where.passive ? few_triangles : triangle_count).mesh;
  std::vector<Verdict> verdicts;
  try {
    const auto renderer = catalogue.make(model, surface::make_embree_surface(mesh));
    for (const double mass_kg : setup.device_masses_kg) {
      const LoopParameters own = setup.with_mass(mass_kg);
      const Judgement judged = where.passive
                                   ? beside_exact_wall(*renderer, path, own, stiffness->second, radius_m, thresholds)
                                   : judge_loop(*renderer, path, own, thresholds);
      if (verdicts.empty() || judged.buzz.jnd > out.worst.buzz.jnd) out.worst = judged;
      verdicts.push_back(judged.verdict);
      if (!judged.too_slow) continue;
      out.refused = sentence(judged);
      break;
    }
  } catch (const BadData& error) {
    out.refused = error.what();
  }
  out.verdict = agreed(verdicts);
  return out;
}

std::vector<AtlasFinding> atlas_findings(const std::vector<AtlasAnswer>& answers,
                                         const std::vector<AtlasAnswer>& reference) {
  std::vector<AtlasFinding> found;
  const auto add = [&found](const std::string& name, const AtlasAnswer& answer, double jnd) {
    auto own = std::ranges::find(found, name, &AtlasFinding::name);
    if (own == found.end()) own = found.insert(found.end(), {name, {}, 0.0, ""});
    own->where.insert(jnd > own->jnd ? own->where.begin() : own->where.end(), answer.where);
    own->jnd = std::max(own->jnd, jnd);
  };
  for (const AtlasCase& own : atlas_cases()) {
    const auto answer = std::ranges::find(answers, own.name, &AtlasAnswer::where);
    const auto right = std::ranges::find(reference, own.name, &AtlasAnswer::where);
    if (answer == answers.end() || (!own.passive && (right == reference.end() || felt(*right)))) continue;
    if (felt(*answer)) {
      const bool plane = own.surface == "plane" && own.friction <= 0.0;
      add(plane                 ? "unstable-below-limit"
          : own.friction <= 0.0 ? "buzz-at-edges"
                                : "buzz-with-friction",
          *answer, answer->worst.buzz.jnd);
    }
    const double kick_jnd = answer->worst.kick_jnd - (own.passive ? 0.0 : right->worst.kick_jnd);
    if (kick_jnd >= 1.0) add("kick", *answer, answer->worst.kick_jnd);
  }
  const bool everywhere = !found.empty() && found.front().name == "unstable-below-limit";
  for (AtlasFinding& own : found) {
    if (everywhere && own.name != found.front().name) own.follows_from = found.front().name;
  }
  return found;
}

}  // namespace touchstone::servo
