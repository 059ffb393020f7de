#include <filesystem>

#include "case_command.h"
#include "case_flags.h"
#include "tool_commands.h"
#include "tool_sweep.h"

namespace touchstone::tool {
namespace {

ExitStatus tool_sweep_command(const std::string& specification, const runs::CaseOptions& options) {
  const runs::SweepDesign design(specification, tool_sweep_parts());
  runs::CaseCommand command;
  command.job = tool_sweep_job(design);
  command.table = tool_sweep_table(design);
  command.words = {"tool", "sweep", std::filesystem::absolute(specification).string()};
  command.describe = [&](std::uint64_t number) { return design.at(number).document; };
  command.one_build = false;
  return run_case_command(command, options).status;
}

}  // namespace

void add_sweep(CLI::App& tool_command, apps::Run& run) {
  auto* const command =
      tool_command.add_subcommand("sweep", "Run many cases: a grid, list or Latin hypercube of contacts and renderers");
  runs::add_design_flags(*command, run, "touchstone-tool-sweep/1", tool_sweep_command);
  command->footer(
      "A case that fails is a row with its error. Exit status 1: cases are missing, or failed.\n"
      "Examples:\n"
      "  touchstone sweep tools.json --csv tools.csv   (the same)\n"
      "  touchstone tool sweep tools.json --shard 1/2 --out a.sqlite");
}

}  // namespace touchstone::tool
