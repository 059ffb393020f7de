
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "contacts/known_contacts.h"
#include "harness/base/atomic_file.h"
#include "harness/report/page_html.h"
#include "tool_commands.h"
#include "tool_renderer_flags.h"
#include "tool_reports/tool_scorecard.h"

namespace touchstone::tool {
namespace {

struct ToolScorecardOptions {
  std::vector<std::string> renderers, cases;
  std::string out = "tool-scorecard";
  bool no_cases = false, no_cost = false;
  ToolRendererFlags flags;
};

// Those of these names; without names the plug-ins', and without plug-ins the program's own.
std::vector<ToolRendererEntry> chosen(const ToolScorecardOptions& options) {
  std::vector<ToolRendererEntry> known = options.flags.entries();
  if (!options.renderers.empty()) {
    std::vector<ToolRendererEntry> named;
    for (const std::string& name : options.renderers) named.push_back(find_tool_renderer(known, name));
    return named;
  }
  if (!options.flags.plugins.libraries.empty())
    std::erase_if(known, [](const ToolRendererEntry& entry) { return entry.library.empty(); });
  return known;
}

ExitStatus tool_scorecard_command(const ToolScorecardOptions& options) {
  const std::vector<ToolRendererEntry> entries = chosen(options);
  std::vector<std::string> names = options.cases;
  if (names.empty() && !options.no_cases) names = contacts::exact_case_names();
  std::vector<KnownContacts> cases;
  for (const std::string& name : names) cases.push_back(contacts::known_contacts(name, options.flags.coupling));
  const std::filesystem::path out = options.out;
  ensure_writable_folder(out);
  report::Provenance provenance = report::make_provenance(apps::command_line());
  std::vector<tool_reports::ToolScorecard> cards;
  for (const ToolRendererEntry& entry : entries) {
    cards.push_back(
        tool_reports::score_tool(entry, options.flags.settings_of(entry, entries), cases, !options.no_cost));
    write_file(out / (entry.name + ".json"), tool_reports::tool_scorecard_to_json(cards.back()));
    fmt::print("{}", tool_reports::tool_scorecard_to_text(cards.back()));
    if (!entry.library.empty()) provenance.inputs.push_back(report::describe_input("plug-in", entry.library));
  }
  report::write_html(out / "index.html", tool_reports::tool_scorecard_page(cards, provenance));
  fmt::print("scorecard: {}\n", (out / "index.html").string());
  const bool all_clean =
      std::ranges::all_of(cards, [](const tool_reports::ToolScorecard& card) { return tool_reports::clean(card); });
  return all_clean ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace

void add_scorecard(CLI::App& tool_command, apps::Run& run) {
  auto* const command = tool_command.add_subcommand(
      "scorecard", "What is wrong with a renderer by name, its errors on exact cases, and what a step costs");
  auto options = std::make_shared<ToolScorecardOptions>();
  command->add_option("--renderer", options->renderers,
                      "Renderers to judge, side by side; all of the plug-ins where not given, or the program's own");
  command->add_option("--case", options->cases, "Only these exact cases; see `touchstone tool list`");
  command->add_flag("--no-cases", options->no_cases, "Checks and cost alone");
  command->add_flag("--no-cost", options->no_cost, "No timing");
  command->add_option("--out", options->out, "Folder: index.html and a JSON per renderer")->capture_default_str();
  options->flags.add_to(*command);
  command->footer(
      "Exit status: 0 nothing wrong was found, 1 something is.\n"
      "Example:\n  touchstone tool scorecard --renderer god-object-tool --case box-corner --out card");
  command->callback([options, &run] { run = [options] { return tool_scorecard_command(*options); }; });
}

}  // namespace touchstone::tool
