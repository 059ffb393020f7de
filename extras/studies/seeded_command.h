// What the commands of experiments over seeds share: their options, and the rows of their seeds.
#pragma once

#include <optional>
#include <string>

#include "case_flags.h"
#include "experiments/seed_cases.h"

namespace touchstone::studies {

struct SeededOptions {
  std::string out;  // folder of the report; empty: none
  runs::CaseOptions cases;
};
// --cases, --shard, --merge and so on; `name` is the experiment's command, in whose --out the rows stand by default.
void add_seeded_flags(CLI::App& command, SeededOptions& options, const std::string& name);
// For a footer, with {0} as the command's name.
std::string seeded_examples(const std::string& name);

struct SeededRun {
  ExitStatus status = ExitStatus::passed;
  std::vector<experiments::StoredSeed> seeds;  // empty: nothing to report of; else all of them, and the first ran
  std::optional<report::InputFile> rows;       // for the report's provenance
};
SeededRun run_seeded(const experiments::SeededExperiment& experiment, SeededOptions options, const std::string& name);

}  // namespace touchstone::studies
