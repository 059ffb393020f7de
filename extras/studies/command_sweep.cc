#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/extras.h"
#include "case_flags.h"
#include "harness/base/json_reader.h"
#include "renderers/catalogue.h"
#include "study_commands.h"
#include "sweep/sweep_cases.h"
#include "synthetic/generators.h"

namespace touchstone::studies {
namespace {

// One of tools with a shape is the business of another extra, with the same options.
std::optional<ExitStatus> swept_as_tools(const std::string& specification) {
  const nlohmann::json document = load_json(specification);
  if (!document.is_object() || document.value("schema", nlohmann::json()) != "touchstone-tool-sweep/1") {
    return std::nullopt;
  }
  const auto extra = apps::find_extra("tool");
  if (!extra) {
    throw UsageError(specification +
                     ": is a sweep of tools with a shape, which needs the extra `tool` (touchstone-tool), and it is "
                     "neither beside this program nor on PATH");
  }
  const auto& words = apps::command_line();  // touchstone-sweep sweep ...
  return run_extra_and_wait(*extra, {words.begin() + 1, words.end()});
}

ExitStatus sweep_command(const std::string& specification, const runs::CaseOptions& options) {
  if (const auto status = swept_as_tools(specification)) return *status;
  const runs::SweepDesign design(specification, sweep::sweep_parts());
  sweep::SweepWorld world({renderers::built_in_catalogue(), synthetic::built_in_generators()}, design);
  runs::CaseCommand command;
  command.job = sweep::sweep_job(design, world);
  command.table = sweep::sweep_table(design);
  command.words = {"sweep", std::filesystem::absolute(specification).string()};
  command.describe = [&](std::uint64_t number) { return design.at(number).document; };
  command.one_build = false;
  return run_case_command(command, options).status;
}

}  // namespace

void add_sweep(CLI::App& program, apps::Run& run) {
  auto* const command = program.add_subcommand(
      "sweep", "Run many cases: a grid, list or Latin hypercube of surfaces, motions and models");
  runs::add_design_flags(*command, run, "touchstone-sweep/1 or, of tools with a shape, touchstone-tool-sweep/1",
                         sweep_command);
  command->footer(
      "A case that fails is a row with its error. Exit status 1: cases are missing, or failed.\n"
      "Examples:\n"
      "  touchstone sweep stiffness.json\n"
      "  touchstone sweep stiffness.json --shard 1/2 --out a.sqlite\n"
      "  touchstone sweep stiffness.json --merge a.sqlite b.sqlite --out all.sqlite --csv all.csv\n"
      "  touchstone sweep stiffness.json --engine slurm --tasks 200 --slurm-options=--partition=short --dry-run");
}

}  // namespace touchstone::studies
