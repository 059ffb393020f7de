#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "apps/mesh_flags.h"
#include "apps/plugin_flags.h"
#include "commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/input_files.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/nearness.h"
#include "harness/report/ctest_measurement.h"
#include "harness/report/page_html.h"
#include "loop_report.h"
#include "renderers/catalogue.h"
#include "setup_flags.h"

namespace touchstone::loop {
namespace {

struct LoopOptions {
  SetupFlags setup;
  std::string model, mesh, mesh_unit = "m", path, recording, out, json;
  std::optional<double> least_margin, most_buzz_N, most_energy_J;
  bool ctest = false;
  apps::MeshFlags meshes;
  apps::PluginFlags plugins;
};

// The larger; no number where one of them is none.
double worse(double a, double b) { return a > b || std::isnan(a) ? a : b; }

void check_options(const LoopOptions& options) {
  for (const auto& [name, value] : {std::pair{"--model", options.model},
                                    {"--mesh", options.mesh},
                                    {"--path", options.path},
                                    {"--out", options.out}}) {
    if (value.empty()) throw UsageError(fmt::format("loop: {} is needed", name));
  }
}

// What a test holds of the loop, the worst of the masses: said to ctest where asked for, and each limit that does not
// hold. A figure that is no number holds none.
ExitStatus hold(const servo::LoopEvaluation& evaluation, const LoopOptions& options) {
  double buzz_N = 0.0, energy_J = 0.0;
  for (const servo::MassRun& run : evaluation.runs) {
    buzz_N = worse(buzz_N, run.judgement.buzz.amplitude_N);
    energy_J = worse(energy_J, run.judgement.energy_J);
  }
  if (options.ctest) {
    fmt::print("{}{}{}", report::measurement("stable_margin", evaluation.stable_margin),
               report::measurement("buzz_N", buzz_N), report::measurement("energy_J", energy_J));
  }
  bool holds = true;
  const auto check = [&holds](const char* name, double value, const char* option, std::optional<double> limit,
                              bool ok) {
    if (!limit || ok) return;
    fmt::print("{} is {:.4g}; {} {:g} does not hold\n", name, value, option, *limit);
    holds = false;
  };
  const auto [margin, buzz, energy] = std::tuple{options.least_margin, options.most_buzz_N, options.most_energy_J};
  check("stable_margin", evaluation.stable_margin, "--least-margin", margin, evaluation.stable_margin >= margin);
  check("buzz_N", buzz_N, "--most-buzz", buzz, buzz_N <= buzz);
  check("energy_J", energy_J, "--most-energy", energy, energy_J <= energy);
  return holds ? ExitStatus::passed : ExitStatus::failed;
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
  std::optional<recording::Recording> recording;
  if (!options.recording.empty()) recording = recording::load_recording(options.recording);
  const std::filesystem::path out = options.out;
  refuse_to_replace_input(out / "result.json");

  const servo::LoopEvaluation evaluation = evaluate_loop(*renderer, path, setup, {});
  std::optional<servo::RecordedComparison> recorded;
  if (recording) recorded = compare_recorded(evaluation, setup, *recording, {});
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs = {report::describe_input("model", options.model), report::describe_input("mesh", options.mesh),
                       report::describe_input("path", options.path),
                       report::describe_input("device", setup.device.file),
                       report::describe_input("grip", setup.grip.file)};
  if (recorded) provenance.inputs.push_back(report::describe_input("recording", options.recording));
  const std::string result = to_json(evaluation, setup, recorded).dump(2) + "\n";
  ensure_writable_folder(out);
  write_file(out / "result.json", result);
  write_html(out / "report.html", loop_page(evaluation, setup, recorded, provenance));
  if (!options.json.empty()) write_file(options.json, result);
  fmt::print("{}\n", evaluation.sentence);
  for (const std::string& sentence : setup.assumed) fmt::print("assumed: {}\n", sentence);
  if (recorded) fmt::print("{}\n", recorded->sentence);
  fmt::print("{}: report.html, result.json\n", options.out);
  const ExitStatus held = hold(evaluation, options);
  return recorded && !recorded->agrees ? ExitStatus::failed : held;
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
  command->add_option(
      "--recording", options->recording,
      "Compare the simulation with a run of the same renderer on the device: live.csv of touchstone hil "
      "render. Fails if they differ by more than is just noticed");
  command->add_option("--out", options->out, "Folder for report.html and result.json");
  command->add_option("--json", options->json, "Write result.json here too");
  command->add_option("--least-margin", options->least_margin,
                      "Fail if stable_margin is less: how many times as large the force may be and stay stable");
  command->add_option("--most-buzz", options->most_buzz_N, "Fail if the loop buzzes with more [N]");
  command->add_option("--most-energy", options->most_energy_J, "Fail if the device gives the hand more [J]");
  command->add_flag("--ctest", options->ctest, "Print stable_margin, buzz_N and energy_J for ctest and CDash");
  options->plugins.add_to(*command);
  command->footer(
      "Exit status 0 whatever the verdict, which is in result.json; 1 if a limit that was asked for does not hold, or "
      "the recording differs.\n"
      "Examples:\n"
      "  touchstone loop --device touch --grip light --model m.json --mesh o.obj --path scan.csv --out r\n"
      "  touchstone loop --device omega.3 --grip firm --set mass_kg=0.2 --set latency_s=0.001 --model m.json --mesh "
      "o.stl --mesh-unit mm --path scan.csv --out r\n"
      "  touchstone loop --device my-device.json --grip light --plugin ./libmine.so --model mine.json --mesh o.obj "
      "--path scan.csv --out r\n"
      "  touchstone loop --device touch --grip light --model m.json --mesh o.obj --path scan.csv --out r --ctest "
      "--least-margin 1.5 --most-buzz 0.05");
  command->callback([command, options, &run] {
    if (command->get_subcommands().empty()) run = [options] { return loop_command(*options); };
  });
}

}  // namespace touchstone::loop
