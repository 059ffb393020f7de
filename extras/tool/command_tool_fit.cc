
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "harness/base/atomic_file.h"
#include "harness/base/units.h"
#include "harness/recording/recording_file.h"
#include "harness/report/page_html.h"
#include "harness/report/rendered_input.h"
#include "harness/surface/mesh_file.h"
#include "tool_commands.h"
#include "tool_fitting/tool_fit.h"
#include "tool_fitting/tool_fit_page.h"
#include "tool_renderer_flags.h"

namespace touchstone::tool {
namespace {

struct ToolFitOptions {
  std::string renderer, recording, object_mesh, out;
  ToolShapeFlags tool;
  ToolRendererFlags flags;
};

ExitStatus tool_fit_command(const ToolFitOptions& options) {
  const std::vector<ToolRendererEntry> known = options.flags.entries();
  const ToolRendererEntry& entry = find_tool_renderer(known, options.renderer);
  const ToolSettings declared = options.flags.settings_of(entry, {&entry, 1});
  const Tool shape = options.tool.load();
  const surface::TriangleMesh object = surface::load_mesh(options.object_mesh, length_unit_factor(options.tool.unit));
  const recording::Recording recording = recording::load_recording(options.recording);
  const std::filesystem::path out = options.out;
  ensure_writable_folder(out);
  const tool_fitting::ToolFit fit = tool_fitting::fit_tool(
      recording,
      [&](const Coupling& coupling) {
        ToolSettings settings = declared;
        settings.coupling = coupling;
        return make_tool_renderer(entry, shape, object, settings);
      },
      declared.coupling);
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs = {report::describe_input("recording", options.recording),
                       report::describe_input("tool", options.tool.file),
                       report::describe_input("object", options.object_mesh)};
  write_file(out / "tool-fit.json", tool_fitting::tool_fit_json(fit));
  write_html(out / "report.html", tool_fitting::tool_fit_page(recording, fit, provenance));
  fmt::print("{}report: {}\n", tool_fitting::tool_fit_text(fit), (out / "report.html").string());
  return ExitStatus::passed;
}

}  // namespace

void add_fit(CLI::App& tool_command, apps::Run& run) {
  auto* const fit = tool_command.add_subcommand("fit",
                                                "Which effect of the instrument is missing in a measured force and "
                                                "torque: biases, weight, lever arm, how far the "
                                                "tool gives way");
  auto options = std::make_shared<ToolFitOptions>();
  fit->add_option("recording", options->recording,
                  "Measured: t_s, the handle's pose (x_m, y_m, z_m, qw, qx, qy, qz), fx_N.., tx_Nm.. (on the tool, "
                  "about the handle, axes of the object)")
      ->required();
  fit->add_option("--renderer", options->renderer, "See `touchstone tool list`")->required();
  options->tool.add_to(*fit)->required();
  fit->add_option("--object", options->object_mesh, "Closed mesh of the object")->required();
  fit->add_option("--mesh-unit", options->tool.unit, "Unit of both meshes' coordinates: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  fit->add_option("--out", options->out, "Folder: tool-fit.json and report.html")->required();
  options->flags.add_to(*fit);
  fit->footer(
      "Half of the time is fitted; by a quarter effects are chosen, each against the same without it; a quarter is "
      "kept "
      "for the errors that are reported. The stiffnesses that are given are the declared ones.\n"
      "Example:\n  touchstone tool fit measured.csv --renderer god-object-tool --tool tool.obj --object object.obj "
      "--out fitted");
  fit->callback([options, &run] { run = [options] { return tool_fit_command(*options); }; });
}

}  // namespace touchstone::tool
