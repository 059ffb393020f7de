#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/mesh_flags.h"
#include "apps/plugin_flags.h"
#include "commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/input_files.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/nearness.h"
#include "harness/report/page_html.h"
#include "loop_report.h"
#include "renderers/catalogue.h"
#include "setup_flags.h"

namespace touchstone::loop {
namespace {

struct LoopOptions {
  SetupFlags setup;
  std::string model, mesh, mesh_unit = "m", path, out, json;
  apps::MeshFlags meshes;
  apps::PluginFlags plugins;
};

void check_options(const LoopOptions& options) {
  for (const auto& [name, value] : {std::pair{"--model", options.model},
                                    {"--mesh", options.mesh},
                                    {"--path", options.path},
                                    {"--out", options.out}}) {
    if (value.empty()) throw UsageError(fmt::format("loop: {} is needed", name));
  }
}

ExitStatus loop_command(const LoopOptions& options) {
  check_options(options);
  const servo::LoopSetup setup = options.setup.make();
  const rendering::Model model = apps::load_model(options.model, options.plugins.load());
  renderers::find_renderer(model);  // a misspelt name is said before a large mesh is read
  const surface::TriangleMesh mesh = options.meshes.load(options.mesh, options.mesh_unit);
  const auto surface = options.meshes.surface(mesh);
  const auto renderer = renderers::make_renderer(model, surface);
  options.meshes.warn(mesh, *surface);
  const MotionColumns path = recording::load_trajectory(options.path).motion;
  if (const auto message = rendering::fits_another_unit(*surface, path.p_W_m, 0.0, options.path, options.mesh_unit))
    throw BadData(*message);
  const std::filesystem::path out = options.out;
  refuse_to_replace_input(out / "result.json");

  const servo::LoopEvaluation evaluation = evaluate_loop(*renderer, path, setup, {});
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs = {report::describe_input("model", options.model), report::describe_input("mesh", options.mesh),
                       report::describe_input("path", options.path),
                       report::describe_input("device", setup.device.file),
                       report::describe_input("grip", setup.grip.file)};
  const std::string result = to_json(evaluation, setup).dump(2) + "\n";
  ensure_writable_folder(out);
  write_file(out / "result.json", result);
  write_html(out / "report.html", loop_page(evaluation, setup, provenance));
  if (!options.json.empty()) write_file(options.json, result);
  fmt::print("{}\n", evaluation.sentence);
  for (const std::string& sentence : setup.assumed) fmt::print("assumed: {}\n", sentence);
  fmt::print("{}: report.html, result.json\n", options.out);
  return ExitStatus::passed;
}

}  // namespace

void add_loop(CLI::App& program, apps::Run& run) {
  auto* const command = program.add_subcommand(
      "loop", "Will it buzz? The hand, a haptic device and a renderer as a closed loop, simulated exactly");
  command->require_subcommand(0, 1);
  add_width(*command, run);
  add_tune(*command, run);
  add_atlas(*command, run);
  add_fit(*command, run);
  auto options = std::make_shared<LoopOptions>();
  options->setup.add_to(*command);
  command->add_option("--model", options->model, "Model file (touchstone-model/1)");
  command->add_option("--mesh", options->mesh, "The object: OBJ, OFF, PLY or STL, also .gz");
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  options->meshes.add_repair_to(*command);
  options->meshes.add_two_sided_to(*command);
  command->add_option(
      "--path", options->path,
      "Where the hand means to be over time: CSV or HDF5 with t_s, x_m, y_m, z_m, into the object where "
      "it presses");
  command->add_option("--out", options->out, "Folder for report.html and result.json");
  command->add_option("--json", options->json, "Write result.json here too");
  options->plugins.add_to(*command);
  command->footer(
      "Exit status 0 whatever the verdict; it is in result.json.\n"
      "Examples:\n"
      "  touchstone loop --device touch --grip light --model m.json --mesh o.obj --path scan.csv --out r\n"
      "  touchstone loop --device omega.3 --grip firm --set mass_kg=0.2 --set latency_s=0.001 --model m.json --mesh "
      "o.stl --mesh-unit mm --path scan.csv --out r\n"
      "  touchstone loop --device my-device.json --grip light --plugin ./libmine.so --model mine.json --mesh o.obj "
      "--path scan.csv --out r");
  command->callback([command, options, &run] {
    if (command->get_subcommands().empty()) run = [options] { return loop_command(*options); };
  });
}

}  // namespace touchstone::loop
