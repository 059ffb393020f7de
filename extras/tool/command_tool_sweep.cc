#include <filesystem>
#include <memory>

#include "apps/case_flags.h"
#include "harness/runs/case_command.h"
#include "tool_commands.h"
#include "tool_sweep.h"

namespace touchstone::tool {
namespace {

struct ToolSweepOptions {
  std::string specification;
  runs::CaseOptions cases;
};

ExitStatus tool_sweep_command(const ToolSweepOptions& options) {
  const runs::SweepDesign design(options.specification, tool_sweep_parts());
  runs::CaseCommand command;
  command.job = tool_sweep_job(design);
  command.table = tool_sweep_table(design);
  command.words = {"tool", "sweep", std::filesystem::absolute(options.specification).string()};
  command.describe = [&](std::uint64_t number) { return design.at(number).document; };
  command.one_build = false;
  return run_case_command(command, options.cases).status;
}

}  // namespace

void add_sweep(CLI::App& tool_command, apps::Run& run) {
  auto* const command =
      tool_command.add_subcommand("sweep", "Run many cases: a grid, list or Latin hypercube of contacts and renderers");
  auto options = std::make_shared<ToolSweepOptions>();
  command->add_option("SPEC", options->specification, "touchstone-tool-sweep/1 (JSON); see docs/how-to/many-cases.md")
      ->required();
  command->add_option("--out", options->cases.file, "Results (SQLite); a run that stopped goes on in it")
      ->default_str("SPEC with .sqlite");
  apps::add_case_flags(*command, options->cases, "cases");
  command->footer(
      "A case that fails is a row with its error. Exit status 1: cases are missing, or failed.\n"
      "Examples:\n"
      "  touchstone sweep tools.json --csv tools.csv   (the same)\n"
      "  touchstone tool sweep tools.json --shard 1/2 --out a.sqlite");
  command->callback([options, &run] {
    if (options->cases.file.empty())
      options->cases.file = std::filesystem::path(options->specification).replace_extension(".sqlite").string();
    run = [options] { return tool_sweep_command(*options); };
  });
}

}  // namespace touchstone::tool
