#include "servo/atlas.h"

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::servo {
namespace {

constexpr double kHalfWay_m = 0.012;
constexpr double kSpeed_m_per_s = 0.016;
constexpr double kAbove_m = 2e-3;
constexpr double kDown_s = 0.3;
constexpr double kHold_s = 0.4;
constexpr double kPress_N = 1.0;
constexpr std::size_t kTriangles = 10000;

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
  const double deep_m = kPress_N / stiffness;
  MotionColumns path;
  const double slide_s = 2.0 * kHalfWay_m / kSpeed_m_per_s;
  const double whole_s = kDown_s + kHold_s + slide_s + kHold_s;
  for (double t = 0.0; t < whole_s; t += 1e-3) {
    const double along = std::clamp((t - kDown_s - kHold_s) / slide_s, 0.0, 1.0);
    const double x_m = -kHalfWay_m + 2.0 * kHalfWay_m * along;
    const double down = std::min(1.0, t / kDown_s);
    path.t_s.push_back(t);
    path.p_W_m.emplace_back(x_m, 1e-4, top_m(shape, x_m) + kAbove_m - down * (kAbove_m + deep_m));
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

AtlasAnswer atlas_answer(const rendering::Catalogue& catalogue, const rendering::Generators& generators,
                         rendering::Model model, const AtlasCase& where, const LoopSetup& setup,
                         const perception::Thresholds& thresholds) {
  AtlasAnswer out;
  out.renderer = model.renderer;
  out.where = where.name;
  if (where.friction > 0.0) {
    rendering::NamedParameters friction;
    friction.name = "coulomb-friction";
    friction.parameters = {{"mu_static", where.friction}, {"mu_dynamic", where.friction}};
    model.effects.push_back(friction);
  }
  const MotionColumns path = atlas_path(*generators.surface(where.surface, where.parameters), setup.parameters);
  const auto mesh = generators.mesh(where.surface, where.parameters, kTriangles).mesh;
  std::vector<Verdict> verdicts;
  try {
    const auto renderer = catalogue.make(model, surface::make_embree_surface(mesh));
    for (const double mass_kg : setup.device_masses_kg) {
      const Judgement own = judge_loop(*renderer, path, setup.with_mass(mass_kg), thresholds);
      verdicts.push_back(own.verdict);
      if (verdicts.size() == 1 || own.buzz.jnd > out.worst.buzz.jnd) out.worst = own;
    }
  } catch (const BadData& error) {
    out.refused = error.what();
  }
  out.verdict = agreed(verdicts);
  return out;
}

}  // namespace touchstone::servo
