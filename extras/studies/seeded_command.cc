#include "seeded_command.h"

#include <fmt/format.h>

#include <filesystem>

#include "harness/base/atomic_file.h"

namespace touchstone::studies {

void add_seeded_flags(CLI::App& command, SeededOptions& options, const std::string& name) {
  runs::add_case_file_flags(command, options.cases, name + ".sqlite in --out; without either, kept nowhere");
  runs::add_case_flags(command, options.cases, "seeds");
}

std::string seeded_examples(const std::string& name) {
  return fmt::format(
      "  touchstone experiment {0} --seeds 20 --cases a.sqlite --shard 1/2   (and b.sqlite with 2/2 elsewhere)\n"
      "  touchstone experiment {0} --seeds 20 --merge a.sqlite b.sqlite --out {0}\n"
      "  touchstone experiment {0} --seeds 20 --out {0} --engine slurm --slurm-options=--partition=short",
      name);
}

SeededRun run_seeded(const experiments::SeededExperiment& experiment, SeededOptions options, const std::string& name) {
  if (!options.out.empty() && !options.cases.dry_run) ensure_writable_folder(options.out);
  if (options.cases.file.empty() && !options.out.empty())
    options.cases.file = (std::filesystem::path(options.out) / (name + ".sqlite")).string();
  const runs::CaseOutcome outcome = run_case_command(experiments::seed_command(experiment), options.cases);
  SeededRun run;
  run.status = outcome.status;
  if (!outcome.store) return run;
  run.seeds = experiments::stored_seeds(experiment, *outcome.store);
  for (const auto& own : run.seeds) {
    if (own.error.empty()) continue;
    fmt::print(stderr, "seed {}: {}\n", experiment.first_seed + experiment.seed_step * own.number, own.error);
  }
  if (!run.seeds.front().error.empty()) {
    fmt::print(stderr, "the report shows the first seed, which could not be run: there is none\n");
    run.seeds.clear();
  }
  run.rows = runs::stored_rows(*outcome.store, options.cases);
  return run;
}

}  // namespace touchstone::studies
