#include "experiments/seed_spread.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiments/rows.h"
#include "harness/report/console.h"

namespace touchstone::experiments {
namespace {

Rows value_rows(const SeedSpread& spread) {
  Rows rows{{"value", "median", "least", "largest"}};
  for (const auto& own : spread.values) {
    auto sorted = own.of_seed;
    if (!std::all_of(sorted.begin(), sorted.end(), [](double value) { return std::isfinite(value); })) {
      rows.push_back({own.name, "none", "none", "none"});  // not in every seed
      continue;
    }
    std::sort(sorted.begin(), sorted.end());
    const double median = 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
    rows.push_back({own.name, fmt::format("{:.4g}", median), fmt::format("{:.4g}", sorted.front()),
                    fmt::format("{:.4g}", sorted.back())});
  }
  return rows;
}

Rows finding_rows(const SeedSpread& spread) {
  Rows rows{{"finding of the paper", "holds in", "of"}};
  for (const auto& own : spread.findings) {
    const auto held = std::count(own.held.begin(), own.held.end(), true);
    rows.push_back({own.statement, fmt::format("{}", held), fmt::format("{}", own.held.size())});
  }
  return rows;
}

bool several(const SeedSpread& spread) { return !spread.values.empty() && spread.values.front().of_seed.size() > 1; }

}  // namespace

void SeedSpread::add(const std::vector<std::pair<std::string, double>>& values_of_seed,
                     const std::vector<std::pair<std::string, bool>>& findings_of_seed) {
  if (values.empty() && findings.empty()) {
    for (const auto& [name, value] : values_of_seed) values.push_back({name, {}});
    for (const auto& [statement, held] : findings_of_seed) findings.push_back({statement, {}});
  }
  const auto same = [](const auto& known, const auto& given, auto name) {
    return std::equal(known.begin(), known.end(), given.begin(), given.end(),
                      [name](const auto& own, const auto& other) { return own.*name == other.first; });
  };
  if (!same(values, values_of_seed, &Value::name) || !same(findings, findings_of_seed, &Finding::statement)) {
    throw std::invalid_argument("a seed has other values or findings than the first");
  }
  for (std::size_t i = 0; i < values.size(); ++i) values[i].of_seed.push_back(values_of_seed[i].second);
  for (std::size_t i = 0; i < findings.size(); ++i) findings[i].held.push_back(findings_of_seed[i].second);
}

std::string spread_table(const SeedSpread& spread) {
  if (!several(spread)) return "";
  return fmt::format("\nOver {} seeds\n{}{}", spread.values.front().of_seed.size(),
                     report::align_columns(value_rows(spread)), report::align_columns(finding_rows(spread)));
}

report::Section spread_section(const SeedSpread& spread) {
  report::Section section{"Over the seeds",
                          several(spread) ? fmt::format("The same with {} seeds: other noise, another hand; the other "
                                                        "tables are of the first.",
                                                        spread.values.front().of_seed.size())
                                          : "One seed was run; --seeds runs more.",
                          {},
                          false};
  if (!several(spread)) return section;
  section.blocks.emplace_back(table_of(finding_rows(spread), "In how many seeds the findings hold"));
  section.blocks.emplace_back(table_of(value_rows(spread), "How far the numbers spread over the seeds"));
  return section;
}

}  // namespace touchstone::experiments
