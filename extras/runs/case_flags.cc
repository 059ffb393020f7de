#include "case_flags.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace touchstone::runs {

void add_case_flags(CLI::App& command, CaseOptions& options, const std::string& cases) {
  for (const std::string& word : apps::command_line())
    options.called_as += (options.called_as.empty() ? "" : " ") + word;
  command.add_option("--threads", options.threads, "Default: all cores; with slurm the cores of a task, default 1");
  command.add_option("--shard", options.shard, fmt::format("K/N: only the K-th of N parts of the {}", cases));
  command.add_option("--merge", options.merge, "Put the results of shards together, and say what is missing");
  command.add_flag("--retry-failed", options.retry_failed, fmt::format("Run {} again that failed", cases));
  command.add_option("--csv", options.csv, "Write the rows as CSV, too");
  command
      .add_option("--merge-tolerance", options.merge_tolerance,
                  "Rows that two parts have may differ by this share; default to the bit")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--engine", options.engine,
                  "local, slurm: a job array, or jobs: files for GNU parallel, HTCondor, Kubernetes")
      ->check(CLI::IsMember({"local", "slurm", "jobs"}))
      ->capture_default_str();
  command.add_option("--tasks", options.tasks, "slurm, jobs: how many tasks; default one for 100 cases, or for a seed");
  command.add_option("--attempts", options.attempts, "slurm, jobs: how often lost tasks are sent")
      ->capture_default_str();
  command.add_option("--farm", options.farm,
                     "slurm, jobs: what a task does around the program: modules, container, store on the node (JSON)");
  command.add_option("--slurm-options", options.slurm_options, "slurm: further #SBATCH options");
  command.add_flag("--dry-run", options.dry_run,
                   fmt::format("List the {}, or with slurm or jobs show the scripts; run nothing", cases));
}

void add_case_file_flags(CLI::App& command, CaseOptions& options, const std::string& without) {
  command.add_option("--cases", options.file, "Results (SQLite); a run that stopped goes on in it")
      ->default_str(without);
  command.add_flag("--any-build", options.any_build, "Go on with rows that another build of touchstone made");
}

void add_design_flags(CLI::App& command, apps::Run& run, const std::string& formats, const RunDesign& run_design) {
  struct Options {
    std::string specification;
    CaseOptions cases;
  };
  const auto options = std::make_shared<Options>();
  command.add_option("SPEC", options->specification, formats + " (JSON); see docs/how-to/many-cases.md")->required();
  command.add_option("--out", options->cases.file, "Results (SQLite); a run that stopped goes on in it")
      ->default_str("SPEC with .sqlite");
  add_case_flags(command, options->cases, "cases");
  command.callback([options, &run, run_design] {
    if (options->cases.file.empty())
      options->cases.file = std::filesystem::path(options->specification).replace_extension(".sqlite").string();
    run = [options, run_design] { return run_design(options->specification, options->cases); };
  });
}

report::InputFile stored_rows(const CaseStore& store, const CaseOptions& options) {
  return {options.any_build ? "rows, some perhaps of other builds (content)" : "rows (content)",
          options.file.empty() ? "not kept" : options.file, store.content_hash(),
          options.file.empty() ? 0 : std::filesystem::file_size(options.file)};
}

}  // namespace touchstone::runs
