#include "apps/experiments/seed_spread.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/report/console.h"

namespace touchstone::experiments {
namespace {

using Rows = std::vector<std::vector<std::string>>;

Rows value_rows(const SeedSpread& spread) {
  Rows rows{{"value", "median", "least", "largest"}};
  for (const auto& own : spread.values) {
    auto sorted = own.of_seed;
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

Table to_table(const Rows& rows, std::string caption) {
  Table table;
  table.caption = std::move(caption);
  table.columns = rows.front();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    Table::Row row;
    for (std::size_t c = 0; c < rows[i].size(); ++c) row.cells.push_back({rows[i][c], c > 0, Tone::neutral});
    table.rows.push_back(std::move(row));
  }
  return table;
}

bool several(const SeedSpread& spread) { return !spread.values.empty() && spread.values.front().of_seed.size() > 1; }

}  // namespace

void SeedSpread::add(const std::vector<std::pair<std::string, double>>& values_of_seed,
                     const std::vector<std::pair<std::string, bool>>& findings_of_seed) {
  values.resize(values_of_seed.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].of_seed.empty()) values[i].name = values_of_seed[i].first;
    values[i].of_seed.push_back(values_of_seed[i].second);
  }
  findings.resize(findings_of_seed.size());
  for (std::size_t i = 0; i < findings.size(); ++i) {
    if (findings[i].held.empty()) findings[i].statement = findings_of_seed[i].first;
    findings[i].held.push_back(findings_of_seed[i].second);
  }
}

std::string spread_table(const SeedSpread& spread) {
  if (!several(spread)) return "";
  return fmt::format("\nOver {} seeds\n{}{}", spread.values.front().of_seed.size(), align_columns(value_rows(spread)),
                     align_columns(finding_rows(spread)));
}

Section spread_section(const SeedSpread& spread) {
  Section section{"Over the seeds",
                  several(spread) ? fmt::format("The same with {} seeds: other noise, another hand; the tables above "
                                                "are of the first.",
                                                spread.values.front().of_seed.size())
                                  : "One seed was run; --seeds runs more.",
                  {},
                  false};
  if (!several(spread)) return section;
  section.blocks.emplace_back(to_table(finding_rows(spread), "In how many seeds the findings hold"));
  section.blocks.emplace_back(to_table(value_rows(spread), "How far the numbers spread over the seeds"));
  return section;
}

}  // namespace touchstone::experiments
