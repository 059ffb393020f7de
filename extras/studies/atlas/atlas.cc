#include "atlas/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "renderers/mesh_traversal/contact_mesh.h"
#include "shared_cache.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::atlas {

namespace {

constexpr double half_side = 0.05;
constexpr double relief_height = 0.003;
constexpr double top = 0.008;
// Bodies that are kept; cases that follow one another share theirs.
constexpr std::uint64_t stage_count = 100;
constexpr double step_m = 2e-5;  // along the outline per sample: 20 mm/s at 1 kHz

struct OutPoint {
  Vec3 p_W_m;
  Vec3 n_W;
};

// Along straight parts of an outline in the xz plane, from -x to +x.
std::vector<OutPoint> trace(const std::vector<Vec3>& corners) {
  std::vector<OutPoint> out;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vec3 along = corners[i + 1] - corners[i];
    const Vec3 n = Vec3(-along.z(), 0.0, along.x()).normalized();
    const auto steps = static_cast<int>(std::ceil(along.norm() / step_m));
    for (int k = 0; k < steps; ++k) out.push_back({corners[i] + along * ((k + 0.5) / steps), n});
  }
  return out;
}

// A body, its mesh's surface, and the way over it.
struct Stage {
  std::shared_ptr<const synthetic::AnalyticSurface> body;
  std::shared_ptr<const surface::Surface> mesh;
  std::shared_ptr<const renderers::ContactMesh> contact;  // kept, so that the cases' renderers share it
  std::vector<OutPoint> out;
};

Stage make_stage(Scene scene, double sharpness) {
  Stage stage;
  const double y = 0.00123;  // not along an edge of the mesh
  if (scene == Scene::bump) {
    const synthetic::ParameterOverrides parameters{
        {"height_m", relief_height}, {"top_width_m", top}, {"side_angle_rad", sharpness}, {"half_side_m", half_side}};
    stage.body = synthetic::make_surface("extrusion", parameters);
    stage.mesh = make_embree_surface(synthetic::make_mesh("extrusion", parameters, 2000).mesh);
    const double foot = 0.5 * top + relief_height / std::tan(sharpness);
    stage.out = trace({{-foot - 0.01, y, 0},
                       {-foot, y, 0},
                       {-0.5 * top, y, relief_height},
                       {0.5 * top, y, relief_height},
                       {foot, y, 0},
                       {foot + 0.01, y, 0}});
  } else {
    const synthetic::ParameterOverrides parameters{{"thickness_m", sharpness}, {"half_side_m", half_side}};
    stage.body = synthetic::make_surface("thin-shell", parameters);
    stage.mesh = make_embree_surface(synthetic::make_mesh("thin-shell", parameters, 2000).mesh);
    stage.out = trace({{-0.02, y, 0}, {0.02, y, 0}});
  }
  stage.contact = renderers::contact_mesh(stage.mesh);
  return stage;
}

const std::vector<double>& sharpnesses(const AtlasGrid& grid, Scene scene) {
  return scene == Scene::bump ? grid.side_angles_rad : grid.thicknesses_m;
}

rendering::Model make_model(const std::string& renderer, double stiffness_N_per_m, double mu) {
  rendering::Model model;
  model.renderer = renderer;
  model.source = "atlas";
  const rendering::RendererEntry& entry = renderers::find_renderer(model);
  const auto has = [&](const std::string& name) {
    return std::any_of(entry.parameters.begin(), entry.parameters.end(),
                       [&](const rendering::ParameterDeclaration& declared) { return declared.name == name; });
  };
  if (has("stiffness_N_per_m")) model.parameters["stiffness_N_per_m"] = stiffness_N_per_m;
  if (mu > 0.0 && has("mu_static")) {
    model.parameters["mu_static"] = model.parameters["mu_dynamic"] = mu;
  } else if (mu > 0.0) {
    model.effects.push_back({"coulomb-friction", {{"mu_static", mu}, {"mu_dynamic", mu}}, "/effects/0"});
  }
  return model;
}

Anomalies run_on(const Stage& stage, const AtlasCase& one, double force_N) {
  const auto renderer = renderers::make_renderer(make_model(one.renderer, one.stiffness_N_per_m, one.mu), stage.mesh);
  renderer->reset();
  const double depth = force_N / one.stiffness_N_per_m;
  std::vector<TrackedContact> run;
  run.reserve(stage.out.size());
  const OutPoint& first = stage.out.front();
  double t_s = 0.0;
  // Straight down at the first place; what follows is looked at.
  double press = -1e-3;
  while (press < depth) {
    renderer->step({t_s += 1e-3, first.p_W_m - press * first.n_W, Quat::Identity()});
    press += 1e-4;
  }
  for (const OutPoint& out : stage.out) {
    const Vec3 tip = out.p_W_m - depth * out.n_W;
    const rendering::StepResult step = renderer->step({t_s += 1e-3, tip, Quat::Identity()});
    TrackedContact now;
    now.contact = step.contact;
    now.contact_W_m = step.contact_W_m;
    now.f_W_N = step.f_W_N;
    now.own_n_W = stage.body->closest(step.contact_W_m).n_W;
    now.exact_W_m = out.p_W_m;
    now.exact_n_W = out.n_W;
    now.exact_depth_m = depth;
    // Pressed through a thin plate the tip is outside and rightly held: only above the object is it free.
    const double outside = stage.body->closest(tip).signed_distance_m;
    now.tip_outside_m = one.scene == Scene::shell ? std::min(outside, tip.z()) : outside;
    run.push_back(now);
  }
  AnomalyLimits limits;
  limits.slack_m = one.mu * depth;
  return find_anomalies(run, limits);
}

}  // namespace

std::string name_of(Scene scene) { return scene == Scene::bump ? "bump" : "shell"; }

std::uint64_t case_count(const AtlasGrid& grid) {
  return grid.renderers.size() * (grid.side_angles_rad.size() + grid.thicknesses_m.size()) *
         grid.stiffnesses_N_per_m.size() * grid.mus.size();
}

AtlasCase case_at(const AtlasGrid& grid, std::uint64_t number) {
  if (number >= case_count(grid)) throw std::out_of_range("the atlas has no such case");
  const std::uint64_t of_sharpness = grid.stiffnesses_N_per_m.size() * grid.mus.size();
  const std::uint64_t bumps = grid.renderers.size() * grid.side_angles_rad.size() * of_sharpness;
  const Scene scene = number < bumps ? Scene::bump : Scene::shell;
  std::uint64_t rest = number < bumps ? number : number - bumps;
  const auto take = [&](const auto& values) {
    const auto& value = values[rest % values.size()];
    rest /= values.size();
    return value;
  };
  AtlasCase one{scene, "", 0.0, 0.0, 0.0, {}, ""};
  one.mu = take(grid.mus);
  one.stiffness_N_per_m = take(grid.stiffnesses_N_per_m);
  one.sharpness = take(sharpnesses(grid, scene));
  one.renderer = take(grid.renderers);
  return one;
}

struct AtlasWorld::State {
  explicit State(double force) : force_N(force) {}
  double force_N;
  runs::SharedCache<Stage> stages{stage_count, [](const Stage&) { return 1; }};
};

AtlasWorld::AtlasWorld(const AtlasGrid& grid) : state_(std::make_unique<State>(grid.force_N)) {
  for (const auto& renderer : grid.renderers) make_model(renderer, 1.0, 0.0);
}
AtlasWorld::~AtlasWorld() = default;

Anomalies AtlasWorld::run(const AtlasCase& one) {
  const auto stage = state_->stages.get(fmt::format("{} {}", name_of(one.scene), one.sharpness),
                                        [&] { return std::make_shared<Stage>(make_stage(one.scene, one.sharpness)); });
  return run_on(*stage, one, state_->force_N);
}

AtlasCase run_case(Scene scene, const std::string& renderer, double sharpness, double stiffness_N_per_m, double mu,
                   double force_N) {
  AtlasCase one{scene, renderer, sharpness, stiffness_N_per_m, mu, {}, ""};
  one.found = run_on(make_stage(scene, sharpness), one, force_N);
  return one;
}

std::string letters(const Anomalies& found) {
  const auto shown = [&](std::size_t count) { return 100 * count >= found.samples && count > 0; };
  std::string text;
  if (shown(found.sticks)) text += "s";
  if (shown(found.pops_through)) text += "p";
  if (shown(found.loses_contact)) text += "l";
  if (shown(found.pulls_inward)) text += "i";
  return text;
}

std::string letters(const AtlasCase& one) { return one.error.empty() ? letters(one.found) : "?"; }

}  // namespace touchstone::atlas
