#include <filesystem>
#include <memory>

#include "apps/case_flags.h"
#include "renderers/catalogue.h"
#include "renderers/tool/tool_catalogue.h"
#include "study_commands.h"
#include "sweep/sweep_cases.h"
#include "sweep/tool_sweep.h"
#include "synthetic/generators.h"
#include "synthetic/tool/known_contacts.h"

namespace touchstone::studies {
namespace {

struct SweepOptions {
  std::string specification;
  runs::CaseOptions cases;
};

ExitStatus sweep_command(const SweepOptions& options) {
  const sweep::SweepDesign design(options.specification);
  sweep::SweepWorld world({renderers::built_in_catalogue(), synthetic::built_in_generators()}, design);
  const sweep::ToolSweep tools{renderers::tool_renderer_catalogue(), synthetic::known_contacts};
  runs::CaseCommand command;
  command.job = design.of_tools() ? tool_sweep_job(design, tools) : sweep_job(design, world);
  command.table = design.of_tools() ? tool_sweep_table(design) : sweep_table(design);
  command.words = {"sweep", std::filesystem::absolute(options.specification).string()};
  command.describe = [&](std::uint64_t number) { return design.at(number).document; };
  command.one_build = false;
  return run_case_command(command, options.cases).status;
}

}  // namespace

void add_sweep(CLI::App& program, apps::Run& run) {
  auto* const command = program.add_subcommand(
      "sweep", "Run many cases: a grid, list or Latin hypercube of surfaces, motions and models");
  auto options = std::make_shared<SweepOptions>();
  command
      ->add_option("SPEC", options->specification,
                   "touchstone-sweep/1 or, of tools with a shape, touchstone-tool-sweep/1 (JSON); see "
                   "docs/how-to/many-cases.md")
      ->required();
  command->add_option("--out", options->cases.file, "Results (SQLite); a run that stopped goes on in it")
      ->default_str("SPEC with .sqlite");
  apps::add_case_flags(*command, options->cases, "cases");
  command->footer(
      "A case that fails is a row with its error. Exit status 1: cases are missing, or failed.\n"
      "Examples:\n"
      "  touchstone sweep stiffness.json\n"
      "  touchstone sweep stiffness.json --shard 1/2 --out a.sqlite\n"
      "  touchstone sweep stiffness.json --merge a.sqlite b.sqlite --out all.sqlite --csv all.csv\n"
      "  touchstone sweep stiffness.json --engine slurm --tasks 200 --slurm-options=--partition=short --dry-run");
  command->callback([options, &run] {
    if (options->cases.file.empty())
      options->cases.file = std::filesystem::path(options->specification).replace_extension(".sqlite").string();
    run = [options] { return sweep_command(*options); };
  });
}

}  // namespace touchstone::studies
