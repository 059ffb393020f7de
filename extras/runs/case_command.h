// A command that runs many cases, as its user asked: here, in shards, on Slurm, or merged from parts; and what its
// result file holds at the end against what it must hold.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "case_engine.h"
#include "harness/base/error.h"

namespace touchstone::runs {

struct CaseOptions {
  std::string file;  // empty: the rows end with the program
  std::string shard, csv, engine = "local", slurm_options;
  std::vector<std::string> merge;
  double merge_tolerance = 0.0;  // relative
  std::string farm;              // a description of the farm (farm.h)
  unsigned threads = 0;
  std::uint64_t tasks = 0;
  unsigned attempts = 3;
  bool dry_run = false;
  bool retry_failed = false;
  bool any_build = false;  // go on with rows that another build made
  std::string called_as;   // the command line, for provenance
};

struct CaseCommand {
  CaseJob job;
  CaseTable table;
  // How a Slurm task calls it, but for shard and file: {"sweep", "/data/spec.json"}.
  std::vector<std::string> words;
  std::uint64_t cases_of_a_task = 100;                        // where the user does not say how many tasks
  std::function<std::string(std::uint64_t number)> describe;  // a line of --dry-run
  // Rows of another build than this go unnoticed into what is made of them: true refuses them, false says so only.
  bool one_build = true;
};

struct CaseOutcome {
  ExitStatus status = ExitStatus::passed;  // failed: cases are missing, or failed
  // With every case, failed ones as rows with their error; nullptr where some are not there: a shard, a run that
  // stopped, a dry run.
  std::unique_ptr<CaseStore> store;
};

CaseOutcome run_case_command(const CaseCommand& command, const CaseOptions& options);

}  // namespace touchstone::runs
