#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

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
#include "servo/tool_in_hand.h"
#include "setup_flags.h"
#include "tool_renderer_flags.h"

namespace touchstone::loop {
namespace {

struct LoopOptions {
  SetupFlags setup;
  std::string model, renderer, mesh, path, recording, out, json, rendered;
  apps::MeshFlags meshes;
  tool::ToolShapeFlags tool;  // its unit is that of both meshes
  tool::ToolRendererFlags tools;
};

void check_options(const LoopOptions& options) {
  const bool tool = !options.tool.file.empty();
  for (const auto& [name, value] :
       {tool ? std::pair{"--renderer", options.renderer} : std::pair{"--model", options.model},
        {"--mesh", options.mesh},
        {"--path", options.path},
        {"--out", options.out}}) {
    if (value.empty()) throw UsageError(fmt::format("loop: {} is needed", name));
  }
  if (tool && !options.model.empty())
    throw UsageError("loop: --model renders a point; a tool has --renderer and --parameter");
  if (!tool && !options.renderer.empty())
    throw UsageError("loop: --renderer renders a tool: --tool is needed; a point has --model");
}

// What is rendered: a point, or a tool with a shape.
struct Subject {
  std::unique_ptr<rendering::Renderer> renderer;
  surface::TriangleMesh mesh;
  std::shared_ptr<const surface::Surface> surface;
  servo::ToolInHand* tool = nullptr;  // the renderer
  double reach_m = 0.0;               // of the tool, from its handle

  void load(const LoopOptions& options) {
    mesh = options.meshes.load(options.mesh, options.tool.unit);
    surface = options.meshes.surface(mesh);
  }
};

Subject point_subject(const LoopOptions& options) {
  Subject subject;
  const rendering::Model model = apps::load_model(options.model, options.tools.plugins.load());
  renderers::find_renderer(model);  // a misspelt name is said before a large mesh is read
  subject.load(options);
  subject.renderer = renderers::make_renderer(model, subject.surface);
  return subject;
}

Subject tool_subject(const LoopOptions& options) {
  Subject subject;
  const std::vector<tool::ToolRendererEntry> known = options.tools.entries();
  const tool::ToolRendererEntry& entry = find_tool_renderer(known, options.renderer);
  const tool::Tool shape = options.tool.load();
  const std::vector<Vec3>& corners_T_m = shape.shell ? shape.shell->p_T_m : shape.mesh_T.vertices_W_m;
  for (const Vec3& corner_T_m : corners_T_m) subject.reach_m = std::max(subject.reach_m, corner_T_m.norm());
  subject.load(options);
  auto held = std::make_unique<servo::ToolInHand>(
      make_tool_renderer(entry, shape, subject.mesh, options.tools.settings_of(entry, {&entry, 1})));
  subject.tool = held.get();
  subject.renderer = std::move(held);
  return subject;
}

// Of the worst run, which is run once more.
std::optional<servo::ToolInHand::Torque> torque_of(const Subject& subject, const MotionColumns& path,
                                                   const servo::LoopSetup& setup,
                                                   const servo::LoopEvaluation& evaluation) {
  if (subject.tool == nullptr) return std::nullopt;
  run_loop(*subject.renderer, path, setup.with_mass(evaluation.worst().device_mass_kg));
  return subject.tool->torque();
}

// Where the device is and what the renderer answers there, as touchstone replay writes them.
recording::RenderedTrajectory rendered_of(const servo::LoopTrace& trace) {
  return {trace.t_s, trace.tip_W_m, trace.contact_W_m, trace.commanded_W_N, trace.contact, {}};
}

ExitStatus loop_command(const LoopOptions& options) {
  check_options(options);
  const servo::LoopSetup setup = options.setup.make();
  const Subject subject = options.tool.file.empty() ? point_subject(options) : tool_subject(options);
  options.meshes.warn(subject.mesh, *subject.surface);
  const MotionColumns path = recording::load_trajectory(options.path).motion;
  if (const auto message =
          rendering::fits_another_unit(*subject.surface, path.p_W_m, subject.reach_m, options.path, options.tool.unit))
    throw BadData(*message);
  std::optional<recording::Recording> recording;
  if (!options.recording.empty()) recording = recording::load_recording(options.recording);
  const std::filesystem::path out = options.out;
  refuse_to_replace_input(out / "result.json");

  const servo::LoopEvaluation evaluation = evaluate_loop(*subject.renderer, path, setup, {});
  std::optional<servo::RecordedComparison> recorded;
  if (recording) recorded = compare_recorded(evaluation, setup, *recording, {});
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs = {subject.tool != nullptr ? report::describe_input("tool", options.tool.file)
                                               : report::describe_input("model", options.model),
                       report::describe_input("mesh", options.mesh), report::describe_input("path", options.path),
                       report::describe_input("device", setup.device.file),
                       report::describe_input("grip", setup.grip.file)};
  if (recorded) provenance.inputs.push_back(report::describe_input("recording", options.recording));
  nlohmann::json document = to_json(evaluation, setup, recorded);
  const auto torque = torque_of(subject, path, setup, evaluation);
  if (torque) document["torque"] = {{"largest_Nm", torque->largest_Nm}, {"at_s", torque->at_s}};
  const std::string result = document.dump(2) + "\n";
  ensure_writable_folder(out);
  write_file(out / "result.json", result);
  write_html(out / "report.html", loop_page(evaluation, setup, recorded, provenance));
  if (!options.json.empty()) write_file(options.json, result);
  if (!options.rendered.empty()) save_rendered(options.rendered, rendered_of(evaluation.worst().run));
  fmt::print("{}\n", evaluation.sentence);
  for (const std::string& sentence : setup.assumed) fmt::print("assumed: {}\n", sentence);
  if (torque) {
    fmt::print("not fed to the hand: the torque about the handle, up to {:.3g} mNm, at {:.4g} s\n",
               1e3 * torque->largest_Nm, torque->at_s);
  }
  if (recorded) fmt::print("{}\n", recorded->sentence);
  fmt::print("{}: report.html, result.json\n", options.out);
  return recorded && !recorded->agrees ? ExitStatus::failed : ExitStatus::passed;
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
  command->add_option("--model", options->model, "Model file (touchstone-model/1), for a point");
  options->tool.add_to(*command);
  command->add_option("--renderer", options->renderer, "Of the tool; see `touchstone tool list`");
  command->add_option("--mesh", options->mesh, "The object: OBJ, OFF, PLY or STL, also .gz");
  command
      ->add_option("--mesh-unit", options->tool.unit,
                   "Unit of the coordinates of mesh and tool: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  options->meshes.add_repair_to(*command);
  options->meshes.add_two_sided_to(*command);
  command->add_option(
      "--path", options->path,
      "Where the hand means to be over time: CSV or HDF5 with t_s, x_m, y_m, z_m, into the object where "
      "it presses; of a tool its handle, with qw, qx, qy, qz if it turns");
  command->add_option(
      "--recording", options->recording,
      "Compare the simulation with a run of the same renderer on the device: live.csv of touchstone hil "
      "render. Fails if they differ by more than is just noticed");
  command->add_option("--out", options->out, "Folder for report.html and result.json");
  command->add_option("--json", options->json, "Write result.json here too");
  command->add_option("--rendered", options->rendered,
                      "Write the worst run here too, columns as touchstone replay writes them: the device's tip, the "
                      "commanded force, the surface contact point");
  options->tools.add_to(*command);
  command->footer(
      "Exit status 0 whatever the verdict, which is in result.json; 1 if the recording differs.\n"
      "As a test on every commit: a golden case with a loop (touchstone golden new --device).\n"
      "Examples:\n"
      "  touchstone loop --device touch --grip light --model m.json --mesh o.obj --path scan.csv --out r\n"
      "  touchstone loop --device omega.3 --grip firm --set mass_kg=0.2 --set latency_s=0.001 --model m.json --mesh "
      "o.stl --mesh-unit mm --path scan.csv --out r\n"
      "  touchstone loop --device my-device.json --grip light --plugin ./libmine.so --model mine.json --mesh o.obj "
      "--path scan.csv --out r\n"
      "  touchstone loop --device touch --grip light --tool pen.obj --renderer god-object-tool --mesh o.obj --path "
      "poses.csv --out r");
  command->callback([command, options, &run] {
    if (command->get_subcommands().empty()) run = [options] { return loop_command(*options); };
  });
}

}  // namespace touchstone::loop
