#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "apps/plugin_flags.h"
#include "apps/program.h"
#include "case_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/named_values.h"
#include "harness/plugin/plugin_tool.h"
#include "harness/report/page_html.h"
#include "harness/report/page_markdown.h"
#include "tool_atlas/tool_atlas_report.h"
#include "tool_commands.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool {
namespace {

struct ToolAtlasOptions {
  tool_atlas::ToolAtlasGrid grid;
  std::vector<std::string> parameters;
  apps::PluginFlags plugins;
  std::string out;
  runs::CaseOptions cases;
};

void write_report(const std::filesystem::path& out, const std::vector<tool_atlas::ToolAtlasCase>& cases,
                  const runs::CaseOutcome& outcome, const ToolAtlasOptions& options) {
  write_file(out / "atlas.json", tool_atlas::tool_atlas_to_json(cases));
  write_file(out / "maps.svg", tool_atlas::tool_atlas_picture(cases));
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(runs::stored_rows(*outcome.store, options.cases));
  for (const std::string& library : options.plugins.libraries)
    provenance.inputs.push_back(report::describe_input("plug-in", library));
  const report::Page page = tool_atlas::tool_atlas_page(cases, provenance);
  write_html(out / "report.html", page);
  write_file(out / "tables.md", tables_to_markdown(page));
  fmt::print("report: {}\n", (out / "report.html").string());
}

ExitStatus tool_atlas_command(ToolAtlasOptions options) {
  if (!options.out.empty() && !options.cases.dry_run) ensure_writable_folder(options.out);
  if (options.cases.file.empty() && !options.out.empty())
    options.cases.file = (std::filesystem::path(options.out) / "atlas.sqlite").string();
  std::vector<ToolRendererEntry> entries = tool_renderers::tool_renderer_catalogue();
  runs::CaseCommand command;
  for (const std::string& library : options.plugins.libraries) {
    plugin::add_tool_plugin(library, options.plugins.options(), entries);
    options.grid.plugins.push_back(report::describe_input("plug-in", library).sha256);
    command.words.insert(command.words.end(), {"--plugin", std::filesystem::absolute(library).string()});
  }
  tool_atlas::ToolAtlasGrid& grid = options.grid;
  grid.parameters = named_values("--parameter", options.parameters);
  if (grid.renderers.empty()) {
    for (const ToolRendererEntry& entry : entries) grid.renderers.push_back(entry.name);
  }
  const std::vector<std::string> words = tool_atlas::tool_atlas_words(grid);
  command.words.insert(command.words.begin(), words.begin(), words.end());
  command.job = tool_atlas::tool_atlas_job(grid, entries);
  command.table = tool_atlas::tool_atlas_table(grid);
  command.describe = [&](std::uint64_t number) { return tool_atlas::describe_case(grid, number); };
  const runs::CaseOutcome outcome = run_case_command(command, options.cases);
  if (!outcome.store) return outcome.status;
  const auto cases = tool_atlas::stored_cases(grid, *outcome.store);
  fmt::print("{}\n\n{}", tool_atlas::tool_atlas_sentence(cases), tool_atlas::tool_atlas_text(cases));
  if (!options.out.empty()) write_report(options.out, cases, outcome, options);
  return outcome.status;
}

}  // namespace

void add_atlas(CLI::App& tool_command, apps::Run& run) {
  auto* const command = tool_command.add_subcommand(
      "atlas", "Map where renderers are off by more than a person notices: contact x size or clearance x stiffness");
  auto options = std::make_shared<ToolAtlasOptions>();
  auto& grid = options->grid;
  command->add_option("--out", options->out, "Folder for report.html, tables.md, atlas.json and maps.svg");
  runs::add_case_file_flags(*command, options->cases, "atlas.sqlite in --out; without either, kept nowhere");
  command->add_option("--renderers", grid.renderers, "Names; all where not given, plug-ins' too")->delimiter(',');
  command->add_option("--contacts", grid.contacts, "Exact cases (`touchstone tool list`), and peg for its clearances")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--sizes", grid.sizes, "Of the contacts, of their usual one [1]")
      ->delimiter(',')
      ->check(CLI::Range(0.2, 10.0));
  command->add_option("--clearances", grid.clearances_m, "Of the peg, on each side [m]")
      ->delimiter(',')
      ->check(CLI::Range(1e-6, 5e-3));
  command->add_option("--stiffnesses", grid.stiffnesses_N_per_m, "Of the coupling [N/m]; 2 mNm/rad for each")
      ->delimiter(',')
      ->check(CLI::Range(1.0, 1e6));
  command->add_option("--parameter", options->parameters,
                      "NAME=VALUE of a renderer that has it (`touchstone tool list`); may be given several times");
  options->plugins.add_to(*command);
  runs::add_case_flags(*command, options->cases, "cases");
  command->footer(
      "A run that stopped goes on where it was; a case that cannot be run is a row with its error and stands as ? in "
      "the maps.\nExit status 1: cases are missing, or could not be run.\n"
      "Examples:\n"
      "  touchstone tool atlas --out tool-atlas\n"
      "  touchstone tool atlas --contacts box-corner,peg --renderers voxmap-pointshell --parameter voxel_m=0.00025\n"
      "  touchstone tool atlas --cases a.sqlite --shard 1/2   (and b.sqlite with 2/2 on another machine)");
  command->callback([options, &run] { run = [options] { return tool_atlas_command(*options); }; });
}

}  // namespace touchstone::tool
