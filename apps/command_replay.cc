#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "apps/commands.h"
#include "apps/mesh_flags.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/moving_object.h"
#include "harness/rendering/replay_file.h"
#include "harness/sanity/recording_sample.h"
#include "harness/sanity/sanity.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

struct ReplayOptions {
  std::string model, mesh, mesh_unit = "m", object_path, trajectory, out, timing, json;
  bool flip_force = false;
  MeshFlags meshes;
  PluginFlags plugins;
};

// A recording's own forces show whether it belongs to this mesh. Positions without forces may be anywhere.
void check_recording(const ReplayOptions& options, const Model& model, const Surface& surface) {
  Recording sample = sanity::sample_recording(options.trajectory);
  // Nor is a recording on a moving object one on this mesh at rest.
  if (sample.f_W_N.empty() || !options.object_path.empty()) return;
  if (options.flip_force) sanity::flip_force(sample);
  sanity::SanityContext context;
  context.surface = &surface;
  context.mesh_unit = options.mesh_unit;
  const auto radius = model.parameters.find("tip_radius_m");
  context.tip_radius_m = radius == model.parameters.end() ? 0.0 : radius->second;
  context.force_flipped = options.flip_force;
  for (const std::string& remark : sanity::refuse_insane(sample, context)) fmt::print(stderr, "warning: {}\n", remark);
}

ExitStatus replay_command(const ReplayOptions& options) {
  const Model model = load_model(options.model, options.plugins.load());
  find_renderer(model);  // a misspelt name is said before a large mesh is read
  const TriangleMesh mesh = options.meshes.load(options.mesh, options.mesh_unit);
  const auto began = std::chrono::steady_clock::now();
  const std::shared_ptr<const Surface> surface = options.meshes.surface(mesh);
  std::unique_ptr<Renderer> renderer = make_renderer(model, surface);
  if (!options.object_path.empty()) {
    renderer = std::make_unique<MovingObject>(std::move(renderer), load_trajectory(options.object_path).motion,
                                              options.object_path);
  }
  const double build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
  options.meshes.warn(mesh, *surface);
  check_recording(options, model, *surface);

  const ReplaySummary summary = replay_file(*renderer, options.trajectory, options.out);
  if (!options.timing.empty()) {
    ReplayTiming timing = measure_steps(*renderer, options.trajectory);
    timing.build_ms = build_ms;
    CountedRenderer counted = make_counted_renderer(model, surface);
    if (!options.object_path.empty()) counted = {nullptr, "on a moving object"};
    std::string operations = "null";
    if (counted.renderer) {
      OperationReport report = count_operations(*counted.renderer, options.trajectory);
      report.not_counted = counted.not_counted;
      operations = operations_to_json(report);
      fmt::print("operations of a step: mean {:.1f}, median {:g}, max {}; all {}{} ({})\n", report.mean, report.median,
                 report.max, report.total(), report.not_counted.empty() ? "" : "; not counted: " + report.not_counted,
                 kHowSearchesAreCounted);
    } else {
      fmt::print("operations of a step: not counted: {}\n", counted.not_counted);
    }
    write_file(options.timing, timing_to_json(timing, operations));
    fmt::print(
        "step: mean {:.3f} us, median {:.3f} us, p99 {:.3f} us, p99.9 {:.3f} us, max {:.3f} us; build {:.1f} ms, {} "
        "bytes\n",
        timing.mean_us, timing.median_us, timing.p99_us, timing.p999_us, timing.max_us, timing.build_ms,
        timing.memory_bytes);
  }
  if (!options.json.empty()) {
    write_file(options.json,
               fmt::format("{{\"samples\": {}, \"in_contact\": {}, \"largest_force_N\": {}, \"deepest_m\": {}}}\n",
                           summary.samples, summary.in_contact, summary.largest_force_N, summary.deepest_m));
  }
  fmt::print("{}: {} samples, {} in contact, largest force {:.6g} N, deepest {:.6g} mm\n", options.out, summary.samples,
             summary.in_contact, summary.largest_force_N, summary.deepest_m * 1e3);
  return ExitStatus::passed;
}

}  // namespace

void add_replay(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("replay", "Run one renderer over positions as they are");
  auto options = std::make_shared<ReplayOptions>();
  command->add_option("--model", options->model, "Model file (touchstone-model/1)")->required();
  command->add_option("--mesh", options->mesh, "OBJ, OFF, PLY or STL, also .gz")->required();
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um")
      ->capture_default_str();
  options->meshes.add_repair_to(*command);
  options->meshes.add_two_sided_to(*command);
  command
      ->add_option("--trajectory", options->trajectory,
                   "Positions over time: CSV or HDF5 with t_s, x_m, y_m, z_m; a recording with force is checked as "
                   "`evaluate` checks it")
      ->required();
  command->add_option("--object-path", options->object_path,
                      "The object moves: its poses over time, from the mesh's frame to that of the trajectory (CSV or "
                      "HDF5 with t_s, x_m, y_m, z_m, qw, qx, qy, qz; straight and at constant rate between them)");
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
      "  touchstone replay --plugin ./libmine.so --model mine.json --mesh plane.obj --trajectory in.csv --out out.csv");
  command->callback([options, &run] { run = [options] { return replay_command(*options); }; });
}

}  // namespace touchstone::apps
