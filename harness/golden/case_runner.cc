#include "harness/golden/case_runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/units.h"
#include "harness/base/version.h"
#include "harness/golden/acceptance.h"
#include "harness/golden/comparison/column_file.h"
#include "harness/golden/comparison/comparison_report.h"
#include "harness/golden/felt_verdict.h"
#include "harness/golden/golden_file.h"
#include "harness/golden/golden_summary.h"
#include "harness/golden/judges.h"
#include "harness/golden/loop_case.h"
#include "harness/golden/pictures.h"
#include "harness/plugin/plugin_provenance.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/operations.h"
#include "harness/rendering/replay.h"
#include "harness/rendering/scene_file.h"
#include "harness/rendering/settled_renderer.h"
#include "harness/report/ctest_measurement.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_warnings.h"

namespace touchstone::golden {
using recording::InTrajectory;
using rendering::Model;
using rendering::RendererEntry;
using surface::TriangleMesh;

namespace {

std::string hash_of(const TriangleMesh& mesh) {
  return sha256(sha256(std::as_bytes(std::span(mesh.vertices_W_m))) + sha256(std::as_bytes(std::span(mesh.triangles))));
}

std::string hash_of(const InTrajectory& trajectory) {
  return sha256(sha256(std::as_bytes(std::span(trajectory.motion.t_s))) +
                sha256(std::as_bytes(std::span(trajectory.motion.p_W_m))));
}

// The bodies, and where each is at every sample.
std::string hash_of(const rendering::SceneFile& scene, const InTrajectory& trajectory) {
  std::string all;
  for (const rendering::SceneFileBody& body : scene.bodies) {
    std::vector<double> poses;
    std::size_t segment = 0;
    for (const double t_s : trajectory.motion.t_s) {
      const rendering::BodyPose pose = body.pose.covers(t_s) ? body.pose.at(t_s, segment) : body.pose.first();
      poses.insert(poses.end(), {pose.p_W_m.x(), pose.p_W_m.y(), pose.p_W_m.z(), pose.q_WB.w(), pose.q_WB.x(),
                                 pose.q_WB.y(), pose.q_WB.z()});
    }
    all += hash_of(body.mesh_B) + sha256(std::as_bytes(std::span(poses)));
  }
  return sha256(all);
}

CaseModel read_model(const GoldenCase& golden, const std::string& name, const ChangeModel& change) {
  CaseModel model{name, case_model(golden, name), {}};
  model.runs = model.own;
  if (change) change(model.runs);
  return model;
}

// What a case runs over, and what is said of it.
struct CaseWorld {
  std::unique_ptr<rendering::Renderer> renderer;
  std::shared_ptr<const surface::Surface> surface;  // of one object; empty for a scene
  std::string geometry_sha256;
};

// A parameter as it is set or declared; 0 where there is none.
double value_of(const Model& model, const RendererEntry& entry, const std::string& name) {
  const auto set = model.parameters.find(name);
  if (set != model.parameters.end()) return set->second;
  const auto found = std::ranges::find(entry.parameters, name, &rendering::ParameterDeclaration::name);
  return found == entry.parameters.end() ? 0.0 : found->initial;
}

CaseWorld make_world(const Catalogues& catalogues, const GoldenCase& golden, const Model& model,
                     const InTrajectory& trajectory) {
  CaseWorld world;
  if (golden.scene.empty()) {
    const TriangleMesh mesh = case_mesh(catalogues.generators, golden);
    world.surface = make_embree_surface(mesh);
    world.renderer = catalogues.renderers.make(model, world.surface);
    world.geometry_sha256 = hash_of(mesh);
    if (golden.surface.generator.empty()) {
      for (const std::string& warning : mesh_warnings(*world.surface)) fmt::print(stderr, "warning: {}\n", warning);
    }
    return world;
  }
  rendering::SceneFile file = parse_scene(golden.scene, (golden.folder / "case.json").string() + ": /scene",
                                          golden.folder, rendering::SceneFiles::own_folder);
  file.rescale(golden.scale, golden.speed);
  auto scene = std::make_shared<const rendering::BodyScene>(file.scene());
  for (const rendering::SceneBody& body : scene->bodies) {
    for (const std::string& warning : mesh_warnings(*body.surface_B)) fmt::print(stderr, "warning: {}\n", warning);
  }
  world.renderer = catalogues.renderers.make_scene(model, std::move(scene));
  world.geometry_sha256 = hash_of(file, trajectory);
  return world;
}

double p99(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
  std::ranges::nth_element(values, at);
  return *at;
}

std::shared_ptr<const RunOperations> count_run(const rendering::Catalogue& catalogue, const Model& model,
                                               std::shared_ptr<const surface::Surface> surface,
                                               const InTrajectory& trajectory) {
  const rendering::CountedRenderer counted = catalogue.make_counted(model, std::move(surface));
  if (!counted.renderer) return nullptr;
  const rendering::OperationReport report =
      count_operations(*counted.renderer, rendering::tip_source(trajectory.motion));
  return std::make_shared<const RunOperations>(RunOperations{report.total(), report.max});
}

// What ran, and what the judges found.
void measure(const CheckResult& result, const CaseRun& run, const std::string& hash, std::string& measurements) {
  const auto add = [&](const std::string& name, const auto& value) {
    measurements += report::measurement(name, value);
  };
  for (const auto& [name, value] : metrics_of(result.comparison)) add(name, value);
  if (run.operations) {
    add("operations", static_cast<double>(run.operations->total));
    add("operations_max_step", static_cast<double>(run.operations->max_per_step));
  }
  if (run.loop) {
    for (const auto& [name, value] : metrics_of(*run.loop)) add(name, value);
  } else {
    add("step_p99_us", run.p99_us);
  }
  for (const auto& [name, value] : result.figures) add(name, value);
  add("golden_hash", std::string_view(hash));
}

// Without a golden, or with one that cannot be read: nothing to compare with is never a pass.
TrajectoryColumns load_golden(const std::filesystem::path& file, CheckResult& result) {
  if (!std::filesystem::exists(file)) {
    result.comparison.verdict = Verdict::missing;
    result.comparison.problems.push_back(fmt::format("{}: there is no golden to compare with yet", file.string()));
    return {};
  }
  try {
    return load_columns(file);
  } catch (const Error& error) {
    result.comparison.verdict = Verdict::invalid;
    result.comparison.problems.push_back(error.what());
    return {};
  }
}

// Why a scene is none for this renderer: its bodies move against each other, and it takes one object.
std::string declared_not_to_move(const RendererEntry& entry, const GoldenCase& golden) {
  if (entry.make_scene) return "";
  const rendering::BodyScene scene =
      parse_scene(golden.scene, golden.name, golden.folder, rendering::SceneFiles::own_folder).scene();
  if (scene.bodies.size() < 2 || !scene.moves()) return "";
  return fmt::format("the renderer {} takes one object, and the case has {} that move against each other", entry.name,
                     scene.bodies.size());
}

// Why the case says nothing about this renderer: it takes one object and the case has several that move, its tip is
// another one, or the run starts inside the body and the renderer declares that it cannot.
std::string declared_not_to_run(const Catalogues& catalogues, const GoldenCase& golden, const CaseModel& model) {
  const RendererEntry& entry = catalogues.renderers.find(model.runs);
  // The tip of a case whose renderer only a plug-in has is that plug-in's.
  const auto& known = catalogues.renderers.renderers();
  const auto of_case = std::ranges::find(known, model.own.renderer, &RendererEntry::name);
  if (of_case != known.end()) {
    const double rendered_m = value_of(model.runs, entry, "tip_radius_m");
    const double wanted_m = value_of(model.own, *of_case, "tip_radius_m");
    if (rendered_m != wanted_m)
      return fmt::format("the tip is a ball of {:g} m in radius, the case's of {:g} m{}", rendered_m, wanted_m,
                         wanted_m == 0.0 ? "; is another model the one, as --model god-object-ball?" : "");
  }
  if (!golden.scene.empty()) return declared_not_to_move(entry, golden);
  const rendering::Limitation* const limit = find_limitation(entry.cannot, rendering::Ability::start_inside);
  if (limit == nullptr) return "";
  const InTrajectory trajectory = case_trajectory(catalogues.generators, golden);
  if (trajectory.size() == 0) return "";
  const surface::SurfacePoint first =
      make_embree_surface(case_mesh(catalogues.generators, golden))->closest(trajectory.motion.p_W_m.front());
  return first.signed_distance_m < 0.0 ? "the run starts inside the body: " + limit->reason : "";
}

}  // namespace

TriangleMesh case_mesh(const rendering::Generators& generators, const CaseSurface& surface, double scale) {
  TriangleMesh mesh = surface.generator.empty()
                          ? surface::load_mesh(surface.mesh, length_unit_factor(surface.unit))
                          : generators.mesh(surface.generator, surface.parameters, surface.triangles).mesh;
  for (Vec3& vertex : mesh.vertices_W_m) vertex *= scale;
  return mesh;
}

InTrajectory case_trajectory(const rendering::Generators& generators, const CaseTrajectory& wanted, double scale,
                             double speed) {
  InTrajectory trajectory;
  if (wanted.generator.empty()) {
    trajectory = recording::load_trajectory(wanted.file);
    for (double& t : trajectory.motion.t_s) t /= speed;
  } else {
    trajectory = generators.motion(wanted.generator, wanted.parameters, wanted.seed, wanted.rate_Hz / speed);
    for (std::size_t i = 0; i < trajectory.size(); ++i)
      trajectory.motion.t_s[i] = static_cast<double>(i) / wanted.rate_Hz;
  }
  for (Vec3& p : trajectory.motion.p_W_m) p = scale * (p + wanted.offset_W_m);
  return trajectory;
}

Model case_model(const GoldenCase& golden, const std::string& name) {
  const auto text = golden.models.find(name);
  if (text == golden.models.end()) {
    std::string known;
    for (const auto& [other, ignored] : golden.models) known += ' ' + other;
    throw UsageError(fmt::format("the case {} has no model '{}'; it has:{}", golden.name, name, known));
  }
  Model model = rendering::parse_model(
      text->second, fmt::format("{}: /models/{}", (golden.folder / "case.json").string(), name), golden.folder);
  for (const rendering::NamedParameters& effect : model.effects) {
    if (!effect.image.empty() && effect.image != golden.folder / effect.image.filename()) {
      throw BadData(fmt::format("{}{}/image: a file in the case's own folder was expected, without a path; it is {}",
                                model.source, effect.place, effect.image.string()));
    }
  }
  return model;
}

namespace {

CaseRun run_model(const Catalogues& catalogues, const GoldenCase& golden, const CaseModel& model, bool time_steps) {
  const Model& described = model.runs;
  const InTrajectory trajectory = case_trajectory(catalogues.generators, golden);
  CaseRun run;
  std::string geometry_sha256;
  run.provenance = build_provenance();
  if (golden.loop) {
    const TriangleMesh mesh = case_mesh(catalogues.generators, golden);
    LoopRun closed = run_loop_program(catalogues.loop_program, golden, mesh, trajectory, described);
    run.rendered = std::move(closed.rendered);
    run.loop = std::make_shared<const LoopFigures>(std::move(closed.figures));
    add_to(run.provenance, *run.loop);
    geometry_sha256 = hash_of(mesh);
  } else {
    CaseWorld world = make_world(catalogues, golden, described, trajectory);
    // A golden says what is right at each tip; when the answer comes is what the renderer declares.
    const double lag_samples = value_of(described, catalogues.renderers.find(described), "lag_samples");
    const auto renderer = rendering::settled(std::move(world.renderer), static_cast<int>(std::lround(lag_samples)));
    run.rendered = replay(*renderer, trajectory, time_steps);
    run.p99_us = p99(run.rendered.cost_us);
    run.rendered.cost_us.clear();
    run.surface = world.surface;
    if (world.surface) run.operations = count_run(catalogues.renderers, described, world.surface, trajectory);
    geometry_sha256 = world.geometry_sha256;
  }
  if (described.provided) run.provenance.merge(plugin::plugin_provenance(*described.provided));
  if (described.renderer != model.own.renderer) run.provenance["renderer_in_place"] = described.renderer;
  run.provenance["geometry_sha256"] = geometry_sha256;
  run.provenance["trajectory_sha256"] = hash_of(trajectory);
  run.provenance["seed"] = std::to_string(golden.trajectory.seed);
  if (run.operations) {
    run.provenance["operations"] = std::to_string(run.operations->total);
    run.provenance["operations_max_step"] = std::to_string(run.operations->max_per_step);
  }
  run.provenance["command"] = fmt::format("touchstone check {} --model {}", golden.name, model.name);
  return run;
}

}  // namespace

CaseRun run_case(const Catalogues& catalogues, const GoldenCase& golden, const std::string& model, bool time_steps,
                 const ChangeModel& change) {
  return run_model(catalogues, golden, read_model(golden, model, change), time_steps);
}

namespace {

// What a person needs to look at a failure.
void leave_behind(const CaseCheck& options, const std::filesystem::path& folder, const CaseRun& run,
                  const TrajectoryColumns& obtained, const TrajectoryColumns& expected, CheckResult& result) {
  ensure_writable_folder(folder);
  // Git passes over the folder, so that what a failure leaves does not make a checkout look changed.
  hide_from_git(options.out);
  result.left_in = folder;
  if (!obtained.columns.empty()) write_golden(folder / "obtained.h5", run.rendered, run.provenance);
  write_file(folder / "table.txt", result.table);
  write_file(folder / "comparison.json", to_json_text(result.comparison));
  for (const auto& [name, picture] : draw_pictures(expected, obtained, folder)) {
    if (options.ctest) result.measurements += report::picture_measurement(name, picture);
  }
}

}  // namespace

bool CheckResult::passed() const { return !drift_fails && (felt ? felt->passed : passes(comparison.verdict)); }

CheckResult check_case(const Catalogues& catalogues, const GoldenCase& golden, const std::string& model,
                       const CaseCheck& options) {
  const auto folder = result_folder(options.out, golden.name, model);
  CheckResult result;
  CaseModel wanted;
  CaseRun run;
  TrajectoryColumns obtained, expected;
  const auto invalid = [&](const Error& error) {
    result.comparison.verdict = Verdict::invalid;
    result.comparison.problems.push_back(error.what());
  };
  const auto ask = [&](bool against_golden) {
    const JudgedRun judged{catalogues, golden, wanted, options, run, obtained, expected};
    for (const Judge& judge : judges()) {
      if (judge.needs_golden == against_golden) judge.judge(judged, result);
    }
  };
  try {
    wanted = read_model(golden, model, options.change);
    if (options.change) result.skipped = declared_not_to_run(catalogues, golden, wanted);
    if (!result.skipped.empty()) return result;
    expected = load_golden(golden.expected(model), result);
    try {
      run = run_model(catalogues, golden, wanted, options.ctest);
      obtained = columns_of(run.rendered, fmt::format("{} {}", golden.name, model));
    } catch (const UsageError&) {
      throw;
    } catch (const Error& error) {
      invalid(error);
    }
    if (result.comparison.verdict == Verdict::equal) ask(true);
  } catch (const BadData& error) {
    if (options.change) throw;  // of what the user put in the place of the case's own
    invalid(error);
  }
  ask(false);
  result.table = fmt::format("{} {}\n{}", golden.name, model, to_table(result.comparison));
  clear_result_folder(folder);
  if (options.ctest)
    measure(result, run, obtained.columns.empty() ? "" : summarise(run.rendered).sha256, result.measurements);
  if (!result.passed()) leave_behind(options, folder, run, obtained, expected, result);
  return result;
}

}  // namespace touchstone::golden
