// An experiment over several seeds as cases for the engine (extras/runs/case_engine.h): a seed is a case, its named
// values and findings are its row, and what the report shows of it stands beside them as JSON.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "case_command.h"
#include "experiments/seed_spread.h"

namespace touchstone::experiments {

struct SeedResult {
  std::vector<double> values;  // in the order of the experiment's; NaN for one that this seed does not have
  std::vector<bool> findings;
  std::string document;  // JSON, from which the report is made; the same in every run
  std::string times;     // JSON, of times that are others in every run; or ""
};

struct SeededExperiment {
  std::string name;      // "voxel"
  std::string settings;  // all that a result depends on but its seed, as JSON
  std::uint64_t first_seed = 1;
  std::uint64_t seeds = 1;
  std::uint64_t seed_step = 1;  // how many seeds a case takes
  std::vector<std::string> values;
  std::vector<std::string> findings;
  std::optional<std::size_t> timed_finding;  // which of them rests on times, and is another in other runs
  std::function<SeedResult(std::uint64_t number, const runs::PartDone& part_done)> run;
  std::vector<std::string> words;  // of the command that asks for it

  bool alone = false;       // as CaseJob
  std::uint64_t parts = 1;  // as CaseJob
  std::uint64_t bytes = 0;  // as CaseJob
};

runs::CaseTable seed_table(const SeededExperiment& experiment);
// Throws logic_error if a seed has other values or findings than the experiment declares.
runs::CaseJob seed_job(const SeededExperiment& experiment);
runs::CaseCommand seed_command(const SeededExperiment& experiment);

// One seed's row, read back.
struct StoredSeed {
  std::uint64_t number = 0;
  std::string error;
  SeedResult result;  // where there is no error
};
// Of a store that has all of them, in their order.
std::vector<StoredSeed> stored_seeds(const SeededExperiment& experiment, const runs::CaseStore& store);
// Which of an experiment's values and findings, by their places.
struct SpreadPart {
  std::vector<std::size_t> values, findings;
};
// Over those that ran.
SeedSpread stored_spread(const SeededExperiment& experiment, const std::vector<StoredSeed>& seeds,
                         const SpreadPart& part);
SeedSpread stored_spread(const SeededExperiment& experiment, const std::vector<StoredSeed>& seeds);

}  // namespace touchstone::experiments
