
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "contacts/tool_golden.h"
#include "harness/base/atomic_file.h"
#include "harness/base/version.h"
#include "harness/recording/recording_file.h"
#include "harness/report/page_html.h"
#include "tool_commands.h"
#include "tool_renderers/tool_catalogue.h"
#include "tool_reports/tool_comparison_page.h"

namespace touchstone::tool {
namespace {

struct ToolGoldenOptions {
  std::string golden = "extras/tool/golden/peg-0.2mm.json", accept, reason, out;
  std::vector<std::string> renderers;
};

ExitStatus tool_golden_command(const ToolGoldenOptions& options) {
  const std::vector<ToolRendererEntry>& known = tool_renderers::tool_renderer_catalogue();
  const contacts::ToolGolden golden = contacts::read_tool_golden(options.golden);
  if (!options.accept.empty()) {
    contacts::accept_tool_golden(golden, find_tool_renderer(known, options.accept), options.reason,
                                 build_info().commit);
    fmt::print("accepted: {}\n", golden.answer(options.accept).string());
    return ExitStatus::passed;
  }
  const std::filesystem::path out = options.out;
  if (!options.out.empty()) ensure_writable_folder(out);
  bool all_passed = true;
  for (const std::string& name : options.renderers.empty() ? golden.renderers : options.renderers) {
    const std::filesystem::path file = golden.answer(name);
    const tool_reports::ComparedTools compared{recording::load_recording(file),
                                               contacts::answer_now(golden, find_tool_renderer(known, name)),
                                               {},
                                               {},
                                               golden.coupling,
                                               golden.force_tolerance_N,
                                               golden.torque_tolerance_Nm};
    const ToolComparison c = tool_reports::compared_errors(compared);
    const bool passed = within(c, golden.force_tolerance_N, golden.torque_tolerance_Nm);
    all_passed = all_passed && passed;
    fmt::print("{}: {} samples of {}\n{}", passed ? "passed" : "failed", c.samples, file.string(),
               comparison_to_text(c));
    if (options.out.empty()) continue;
    report::Provenance provenance = report::make_provenance(apps::command_line());
    provenance.inputs = {report::describe_input("golden", golden.file), report::describe_input("expected", file)};
    report::write_html(out / (name + ".html"), tool_reports::tool_comparison_page(compared, c, provenance));
  }
  return all_passed ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace

void add_golden(CLI::App& tool_command, apps::Run& run) {
  auto* const golden = tool_command.add_subcommand(
      "golden", "Hold renderers to what was accepted of a path, per axis of force and torque");
  auto golden_options = std::make_shared<ToolGoldenOptions>();
  golden->add_option("FILE", golden_options->golden, "touchstone-tool-golden/1 (JSON)")->capture_default_str();
  golden->add_option("--renderer", golden_options->renderers, "Only these of those that the file names");
  golden->add_option("--out", golden_options->out, "Folder: a page for each renderer");
  auto* const accept = golden->add_option("--accept", golden_options->accept,
                                          "Take what this renderer answers now for right; on purpose");
  auto* const reason = golden->add_option("--reason", golden_options->reason, "Why it changed");
  accept->needs(reason);
  reason->needs(accept);
  golden->footer(
      "Exit status: 0 all within the tolerances, 1 not.\nExamples:\n  touchstone tool golden\n"
      "  touchstone tool golden --accept god-object-tool --reason 'contacts are found earlier'");
  golden->callback([golden_options, &run] { run = [golden_options] { return tool_golden_command(*golden_options); }; });
}

}  // namespace touchstone::tool
