#include "experiments/seed_cases.h"

#include <fmt/format.h>

#include <stdexcept>

namespace touchstone::experiments {

runs::CaseTable seed_table(const SeededExperiment& experiment) {
  using enum runs::CaseColumn::Type;
  runs::CaseTable table;
  // Not how many seeds: more of them go into the same file.
  table.specification =
      fmt::format(R"({{"schema":"touchstone-seeds/1","experiment":"{}","first_seed":{},"settings":{}}})",
                  experiment.name, experiment.first_seed, experiment.settings);
  table.cases = experiment.seeds;
  table.columns.push_back({"seed", integer});
  for (const std::string& name : experiment.values) table.columns.push_back({name, real});
  for (std::size_t f = 0; f < experiment.findings.size(); ++f)
    table.columns.push_back({experiment.findings[f], integer, experiment.timed_finding == f});
  table.columns.push_back({"document", text});
  table.columns.push_back({"times", text, true});
  table.what = "experiment or of other seeds";
  table.file_option = "--cases";
  return table;
}

runs::CaseJob seed_job(const SeededExperiment& experiment) {
  runs::CaseJob job;
  job.what = experiment.name + " experiment";
  job.cases = experiment.seeds;
  job.alone = experiment.alone;
  job.parts = experiment.parts;
  job.bytes = experiment.bytes;
  job.run = [experiment](runs::CaseRow& row, const runs::PartDone& part_done) {
    row.values.emplace_back(experiment.first_seed + experiment.seed_step * row.number);
    const SeedResult result = experiment.run(row.number, part_done);
    if (result.values.size() != experiment.values.size() || result.findings.size() != experiment.findings.size())
      throw std::logic_error(experiment.name + ": a seed has other values or findings than the experiment");
    for (const double value : result.values) row.values.emplace_back(value);
    for (const bool held : result.findings) row.values.emplace_back(std::uint64_t{held ? 1U : 0U});
    row.values.emplace_back(result.document);
    row.values.emplace_back(result.times);
  };
  return job;
}

runs::CaseCommand seed_command(const SeededExperiment& experiment) {
  runs::CaseCommand command;
  command.job = seed_job(experiment);
  command.table = seed_table(experiment);
  command.words = experiment.words;
  command.cases_of_a_task = 1;
  command.describe = [experiment](std::uint64_t number) {
    return fmt::format(R"({{"experiment":"{}","seed":{}}})", experiment.name,
                       experiment.first_seed + experiment.seed_step * number);
  };
  return command;
}

std::vector<StoredSeed> stored_seeds(const SeededExperiment& experiment, const runs::CaseStore& store) {
  std::vector<StoredSeed> seeds;
  for (const runs::CaseRow& row : store.rows(0, experiment.seeds)) {
    StoredSeed own{row.number, row.error, {}};
    if (own.error.empty()) {
      auto at = row.values.begin() + 1;
      for (std::size_t v = 0; v < experiment.values.size(); ++v) own.result.values.push_back(runs::as_number(*at++));
      for (std::size_t f = 0; f < experiment.findings.size(); ++f)
        own.result.findings.push_back(runs::as_integer(*at++) != 0);
      own.result.document = runs::as_text(*at++);
      own.result.times = runs::as_text(*at);
    }
    seeds.push_back(std::move(own));
  }
  return seeds;
}

SeedSpread stored_spread(const SeededExperiment& experiment, const std::vector<StoredSeed>& seeds,
                         const SpreadPart& part) {
  SeedSpread spread;
  for (const StoredSeed& own : seeds) {
    if (!own.error.empty()) continue;
    std::vector<std::pair<std::string, double>> values;
    for (const std::size_t v : part.values) values.emplace_back(experiment.values.at(v), own.result.values.at(v));
    std::vector<std::pair<std::string, bool>> findings;
    for (const std::size_t f : part.findings)
      findings.emplace_back(experiment.findings.at(f), own.result.findings.at(f));
    spread.add(values, findings);
  }
  return spread;
}

SeedSpread stored_spread(const SeededExperiment& experiment, const std::vector<StoredSeed>& seeds) {
  SpreadPart all;
  for (std::size_t v = 0; v < experiment.values.size(); ++v) all.values.push_back(v);
  for (std::size_t f = 0; f < experiment.findings.size(); ++f) all.findings.push_back(f);
  return stored_spread(experiment, seeds, all);
}

}  // namespace touchstone::experiments
