#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "apps/commands.h"
#include "apps/mesh_flags.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/recording/extent_check.h"
#include "harness/recording/recording_file.h"
#include "harness/recording_checks/check_recording.h"
#include "harness/recording_checks/recording_sample.h"
#include "harness/rendering/moving_object.h"
#include "harness/rendering/nearness.h"
#include "harness/rendering/replay_file.h"
#include "harness/rendering/scene_file.h"
#include "harness/rendering/seam_watch.h"
#include "harness/surface/mesh_topology.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
using rendering::Model;

namespace {

struct ReplayOptions {
  std::string model, mesh, mesh_unit = "m", object_path, scene, trajectory, out, timing, json;
  bool flip_force = false;
  MeshFlags meshes;
  PluginFlags plugins;
};

// A recording's own forces show whether it belongs to this mesh. Positions without forces may be anywhere, unless they
// are near it in another unit alone.
void check_recording(const ReplayOptions& options, const Model& model, const surface::Surface& surface) {
  recording::Recording sample = recording_checks::sample_recording(options.trajectory);
  // Nor is a recording on a moving object one on this mesh at rest.
  if (!options.object_path.empty()) return;
  const auto radius = model.parameters.find("tip_radius_m");
  const double tip_radius_m = radius == model.parameters.end() ? 0.0 : radius->second;
  if (sample.f_W_N.empty()) {
    const auto& tips = sample.motion.p_W_m;
    const auto message =
        rendering::fits_another_unit(surface, tips, tip_radius_m, options.trajectory, options.mesh_unit);
    if (message) throw BadData(*message);
    Box3 path;
    for (const Vec3& tip : tips) path.extend(tip);
    const auto mismatch = recording::check_extents(path, surface.bounds(), options.mesh_unit);
    if (mismatch && !mismatch->apart) fmt::print(stderr, "warning: {}\n", mismatch->message);
    return;
  }
  if (options.flip_force) recording_checks::flip_force(sample);
  recording_checks::RecordingContext context;
  context.surface = &surface;
  context.mesh_unit = options.mesh_unit;
  context.tip_radius_m = tip_radius_m;
  context.force_flipped = options.flip_force;
  for (const std::string& remark : recording_checks::refuse_faulty(sample, context))
    fmt::print(stderr, "warning: {}\n", remark);
}

// What is replayed over, and how long it took to make.
struct Built {
  std::unique_ptr<rendering::Renderer> renderer;
  std::shared_ptr<const surface::Surface> surface;  // of one object; empty for a scene
  std::shared_ptr<rendering::SeamSearch> seams;     // where the tip fell through an open mesh; empty for others
  double build_ms = 0.0;
};

double ms_since(std::chrono::steady_clock::time_point began) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
}

Built build_over_mesh(const ReplayOptions& options, const Model& model) {
  const surface::TriangleMesh mesh = options.meshes.load(options.mesh, options.mesh_unit);
  const auto began = std::chrono::steady_clock::now();
  Built built;
  built.surface = options.meshes.surface(mesh);
  built.renderer = renderers::make_renderer(model, built.surface);
  if (!options.object_path.empty()) {
    built.renderer = std::make_unique<rendering::MovingObject>(
        std::move(built.renderer), recording::load_trajectory(options.object_path).motion, options.object_path);
  }
  built.build_ms = ms_since(began);
  const surface::MeshTopology* const topology = built.surface->topology();
  if (topology != nullptr && topology->open_edge_count > 0 && options.object_path.empty()) {
    built.seams = std::make_shared<rendering::SeamSearch>(built.surface);
    built.renderer = std::make_unique<rendering::SeamWatch>(std::move(built.renderer), built.seams);
  }
  options.meshes.warn(mesh, *built.surface);
  check_recording(options, model, *built.surface);
  return built;
}

Built build_over_scene(const ReplayOptions& options, const Model& model) {
  rendering::SceneFile file = rendering::load_scene(options.scene);
  for (rendering::SceneFileBody& body : file.bodies) options.meshes.repair_if_wanted(body.mesh_B);
  const auto began = std::chrono::steady_clock::now();
  const auto scene = std::make_shared<const rendering::BodyScene>(file.scene(options.meshes.two_sided));
  Built built;
  built.renderer = renderers::make_scene_renderer(model, scene);
  built.build_ms = ms_since(began);
  for (std::size_t i = 0; i < file.bodies.size(); ++i)
    options.meshes.warn(file.bodies[i].mesh_B, *scene->bodies[i].surface_B);
  return built;
}

void check_options(const ReplayOptions& options) {
  if (options.mesh.empty() == options.scene.empty())
    throw UsageError("replay: either --mesh (one object) or --scene (several bodies) is needed, and not both");
  if (!options.scene.empty() && !options.object_path.empty())
    throw UsageError("replay: --object-path moves the object of --mesh; in a scene file each body has its poses");
}

ExitStatus replay_command(const ReplayOptions& options) {
  check_options(options);
  const Model model = load_model(options.model, options.plugins.load());
  renderers::find_renderer(model);  // a misspelt name is said before a large mesh is read
  const Built built = options.scene.empty() ? build_over_mesh(options, model) : build_over_scene(options, model);
  rendering::Renderer* const renderer = built.renderer.get();

  const rendering::ReplaySummary summary = replay_file(*renderer, options.trajectory, options.out);
  if (const std::string warning = built.seams ? seam_warning(built.seams->losses()) : ""; !warning.empty())
    fmt::print(stderr, "warning: {}\n", warning);
  if (!options.timing.empty()) {
    rendering::ReplayTiming timing = measure_steps(*renderer, options.trajectory);
    timing.build_ms = built.build_ms;
    rendering::CountedRenderer counted{nullptr, options.scene.empty() ? "on a moving object" : "in a scene"};
    if (built.surface && options.object_path.empty()) counted = renderers::make_counted_renderer(model, built.surface);
    std::string operations = "null";
    if (counted.renderer) {
      rendering::OperationReport report = count_operations(*counted.renderer, options.trajectory);
      report.not_counted = counted.not_counted;
      operations = operations_to_json(report);
      fmt::print("{}", operations_text(report));
    } else {
      fmt::print("operations of a step: not counted: {}\n", counted.not_counted);
    }
    write_file(options.timing, timing_to_json(timing, operations));
    fmt::print("{}", timing_text(timing));
  }
  if (!options.json.empty()) write_file(options.json, summary_to_json(summary));
  fmt::print("{}", summary_text(summary, options.out));
  return ExitStatus::passed;
}

}  // namespace

void add_replay(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("replay", "Run one renderer over positions as they are");
  auto options = std::make_shared<ReplayOptions>();
  command->add_option("--model", options->model, "Model file (touchstone-model/1)")->required();
  command->add_option("--mesh", options->mesh, "One object: OBJ, OFF, PLY or STL, also .gz");
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  options->meshes.add_repair_to(*command);
  options->meshes.add_weld_to(*command);
  options->meshes.add_two_sided_to(*command);
  command
      ->add_option("--trajectory", options->trajectory,
                   "Positions over time: CSV or HDF5 with t_s, x_m, y_m, z_m; a recording with force is checked as "
                   "`evaluate` checks it")
      ->required();
  command->add_option("--object-path", options->object_path,
                      "The object moves: its poses over time, from the mesh's frame to that of the trajectory (CSV or "
                      "HDF5 with t_s, x_m, y_m, z_m, qw, qx, qy, qz; straight and at constant rate between them)");
  command->add_option("--scene", options->scene,
                      "In place of --mesh: several bodies, each at rest or with poses over time (touchstone-scene/1, "
                      "JSON; docs/how-to/scenes.md)");
  command->add_flag("--flip-force", options->flip_force,
                    "The file has the force BY the probe: check it negated (the replay needs positions alone)");
  command->add_option("--out", options->out, "Rendered file: force, surface contact point, contact (CSV or HDF5)")
      ->required();
  command->add_option("--timing", options->timing,
                      "Write the cost of the steps alone as JSON: microseconds (replays twice more: whole blocks for "
                      "the mean, single steps for the rest), bytes, and floating-point operations where the renderer's "
                      "can be counted");
  command->add_option("--json", options->json, "Write the summary as JSON");
  options->plugins.add_to(*command);
  command->footer(
      "Examples:\n"
      "  touchstone replay --model god-object.json --mesh plane.obj --trajectory in.csv --out rendered.csv\n"
      "  touchstone replay --model god-object.json --mesh scan.stl --mesh-unit mm --trajectory in.h5 --out out.h5 "
      "--timing t.json\n"
      "  touchstone replay --model friction.json --mesh belt.obj --object-path belt-poses.csv --trajectory in.csv "
      "--out "
      "out.csv\n"
      "  touchstone replay --model god-object.json --scene floor-and-wall.json --trajectory in.csv --out out.csv\n"
      "  touchstone replay --plugin ./libmine.so --model mine.json --mesh plane.obj --trajectory in.csv --out out.csv");
  command->callback([options, &run] { run = [options] { return replay_command(*options); }; });
}

}  // namespace touchstone::apps
