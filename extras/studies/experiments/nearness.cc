#include "experiments/nearness.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "harness/report/perception_page.h"
#include "harness/stats/quantile.h"

namespace touchstone::experiments {
using report::Table;
using report::Tone;

namespace pc = perception;

std::vector<Nearness> nearness(const std::vector<const pc::PerceptualEvaluation*>& comparisons) {
  if (comparisons.empty()) throw BadData("no comparison to tell what is nearer by");
  const std::size_t conditions = comparisons.front()->conditions.size();
  for (const auto* const comparison : comparisons) {
    if (comparison->conditions.size() != conditions) {
      throw BadData(fmt::format("a comparison has {} conditions where the first has {}", comparison->conditions.size(),
                                conditions));
    }
  }
  std::vector<Nearness> result;
  for (const double share : {0.9, 1.0}) {
    for (const auto scaling : pc::feature_scalings) {
      Nearness own{scaling, share, {}, {}, comparisons.size()};
      own.nearer.resize(conditions, 0);
      std::vector<std::vector<double>> distances(conditions);
      for (const auto* const comparison : comparisons) {
        const auto of_one = pc::distances_with_scaling(*comparison, scaling, share);
        for (std::size_t c = 0; c < conditions; ++c) {
          distances[c].push_back(of_one[c]);
          own.nearer[c] += of_one[0] < of_one[c] ? 1 : 0;
        }
      }
      for (const auto& of_condition : distances) own.median_distance.push_back(stats::median(of_condition));
      result.push_back(std::move(own));
    }
  }
  return result;
}

Table nearness_table(const std::vector<Nearness>& rows, const std::vector<std::string>& conditions) {
  Table table;
  table.caption = "Median distance under every rule of scaling, and how often what was measured again is nearer";
  table.columns = {"scaling", "explained", conditions.front()};
  for (std::size_t c = 1; c < conditions.size(); ++c) {
    table.columns.push_back(conditions[c]);
    table.columns.emplace_back("nearer than it in");
  }
  for (const auto& own : rows) {
    Table::Row row;
    row.cells = {{std::string(pc::name_of(own.scaling)), false, Tone::neutral},
                 {own.explained_share < 1.0 ? "90 %" : "all", true, Tone::neutral},
                 {fmt::format("{:.4g}", own.median_distance[0]), true, Tone::neutral}};
    for (std::size_t c = 1; c < conditions.size(); ++c) {
      row.cells.push_back({fmt::format("{:.4g}", own.median_distance[c]), true, Tone::neutral});
      const Tone tone = own.nearer[c] == own.compared ? Tone::good : Tone::warning;
      row.cells.push_back({fmt::format("{} of {}", own.nearer[c], own.compared), true, tone});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

void show_first_pair(report::Page& page, const pc::PerceptualEvaluation& first) {
  for (auto sections : {report::perception_result_sections(first), report::perception_signal_sections(first)}) {
    for (auto& own : sections) {
      own.title = "First pair: " + own.title;
      page.sections.push_back(std::move(own));
    }
  }
}

}  // namespace touchstone::experiments
