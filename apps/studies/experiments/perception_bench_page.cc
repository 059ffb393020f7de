#include "apps/studies/experiments/perception_bench_page.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"

namespace touchstone::experiments {
namespace {

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? std::nan("") : static_cast<double>(part) / static_cast<double>(whole);
}

nlohmann::ordered_json bench_number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

// Families in the order of their first case.
std::vector<std::string> families_of(const PerceptionBench& bench) {
  std::vector<std::string> families;
  for (const auto& [family, value] : bench.scores.front().by_family) families.push_back(family);
  return families;
}

Table score_table(const PerceptionBench& bench) {
  Table table;
  table.caption =
      "Clear pairs ordered as the literature's thresholds say, and those of a repeat against each kind of "
      "difference";
  table.columns = {"metric", "clear pairs", "ordered rightly", "undefined"};
  const auto families = families_of(bench);
  for (const auto& family : families) table.columns.push_back(family);
  for (const auto& score : bench.scores) {
    Table::Row row;
    row.cells = {{score.metric, false, Tone::neutral},
                 {fmt::format("{}", score.pairs), true, Tone::neutral},
                 {fmt::format("{:.1f} %", 100.0 * share(score.right, score.pairs)), true, Tone::neutral},
                 {fmt::format("{:.1f} %", 100.0 * share(score.undefined, score.pairs)), true, Tone::neutral}};
    for (const auto& [family, right] : score.by_family)
      row.cells.push_back({fmt::format("{:.0f} %", 100.0 * right), true, Tone::neutral});
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table calibration_table(const PerceptionBench& bench) {
  Table table;
  table.caption = "Stated probabilities against simulated observers who feel the planted difference";
  table.columns = {"stated between", "cases", "stated", "by the thresholds", "simulated observers"};
  for (const auto& bin : bench.calibration) {
    Table::Row row;
    row.cells = {{fmt::format("{:.0f} and {:.0f} %", 100.0 * bin.from, 100.0 * bin.to), false, Tone::neutral},
                 {fmt::format("{}", bin.cases), true, Tone::neutral}};
    for (const double value : {bin.stated, bin.literature, bin.simulated})
      row.cells.push_back({bin.cases > 0 ? fmt::format("{:.1f} %", 100.0 * value) : "none", true, Tone::neutral});
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table case_table(const PerceptionBench& bench) {
  Table table;
  table.caption = "The cases of the first run";
  table.columns = {"case", "d' by the thresholds", "d' judged", "95 %"};
  for (const auto& own : bench.runs.front().cases) {
    Table::Row row;
    row.cells = {{own.planted.name, false, Tone::neutral},
                 {fmt::format("{:.2f}", own.literature), true, Tone::neutral},
                 {fmt::format("{:.2f}", own.d_prime), true, Tone::neutral},
                 {fmt::format("{:.2f} to {:.2f}", own.low95, own.high95), false, Tone::neutral}};
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::string perception_bench_to_json(const PerceptionBench& bench) {
  nlohmann::ordered_json document{{"schema", "touchstone-perception-bench/1"},
                                  {"first_seed", bench.options.first_seed},
                                  {"seeds", bench.options.seeds},
                                  {"cases", bench.cases},
                                  {"below_threshold", bench.below_threshold},
                                  {"called_indistinguishable", bench.called_indistinguishable},
                                  {"interval_covers", bench.covered},
                                  {"largest_miscalibration", bench_number(bench.largest_miscalibration)}};
  document["metrics"] = nlohmann::ordered_json::array();
  for (const auto& score : bench.scores) {
    nlohmann::ordered_json families = nlohmann::ordered_json::object();
    for (const auto& [family, right] : score.by_family) families[family] = right;
    document["metrics"].push_back({{"name", score.metric},
                                   {"clear_pairs", score.pairs},
                                   {"right", score.right},
                                   {"undefined", score.undefined},
                                   {"right_share_by_family", families}});
  }
  document["calibration"] = nlohmann::ordered_json::array();
  for (const auto& bin : bench.calibration) {
    document["calibration"].push_back({{"from", bin.from},
                                       {"to", bin.to},
                                       {"cases", bin.cases},
                                       {"stated", bench_number(bin.stated)},
                                       {"literature", bench_number(bin.literature)},
                                       {"simulated", bench_number(bin.simulated)}});
  }
  document["runs"] = nlohmann::ordered_json::array();
  for (const auto& run : bench.runs) {
    nlohmann::ordered_json cases = nlohmann::ordered_json::array();
    for (const auto& own : run.cases) {
      nlohmann::ordered_json costs = nlohmann::ordered_json::object();
      for (std::size_t m = 0; m < own.cost.size(); ++m) costs[bench.metrics[m]] = bench_number(own.cost[m]);
      cases.push_back({{"name", own.planted.name},
                       {"family", own.planted.family},
                       {"literature_d_prime", own.literature},
                       {"d_prime", own.d_prime},
                       {"d_prime_interval95", {own.low95, own.high95}},
                       {"noticed", own.noticed},
                       {"costs", costs}});
    }
    document["runs"].push_back({{"seed", run.seed},
                                {"stiffness_N_per_m", run.setup.stiffness_N_per_m},
                                {"rate_Hz", run.setup.rate_Hz},
                                {"force_noise_N", run.setup.force_noise_N},
                                {"cases", cases}});
  }
  return document.dump(1) + "\n";
}

std::string perception_bench_table(const PerceptionBench& bench) {
  std::vector<std::vector<std::string>> rows{{"metric", "clear pairs", "ordered rightly", "undefined"}};
  for (const auto& score : bench.scores) {
    rows.push_back({score.metric, fmt::format("{}", score.pairs),
                    fmt::format("{:.1f} %", 100.0 * share(score.right, score.pairs)),
                    fmt::format("{:.1f} %", 100.0 * share(score.undefined, score.pairs))});
  }
  std::string text = align_columns(rows);
  text += fmt::format(
      "below threshold (d' < 0.5): {} of {} called indistinguishable; intervals hold the literature's d' "
      "in {:.1f} % of {} cases; largest miscalibration {:.3f}\n",
      bench.called_indistinguishable, bench.below_threshold, 100.0 * share(bench.covered, bench.cases), bench.cases,
      bench.largest_miscalibration);
  return text;
}

Page perception_bench_page(const PerceptionBench& bench, const Provenance& provenance) {
  Page page;
  page.title = "Perception: every metric on planted differences";
  page.subtitle = fmt::format("{} setups, seeds {} to {}", bench_setups().size(), bench.options.first_seed,
                              bench.options.first_seed + bench.options.seeds - 1);
  Section section;
  section.title = "Which metric orders what people tell apart?";
  section.intro =
      "Presses on a simulated spring with one planted difference each. The d' that each should have follows "
      "from the planted number and published thresholds. A pair is clear if the two d' are more than 2 apart.";
  section.blocks.emplace_back(score_table(bench));
  section.blocks.emplace_back(TextBlock{
      fmt::format("Below threshold (d' < 0.5): {} of {} are called indistinguishable. The 95 % interval holds "
                  "the literature's d' in {:.1f} % of the {} cases.",
                  bench.called_indistinguishable, bench.below_threshold, 100.0 * share(bench.covered, bench.cases),
                  bench.cases),
      Tone::neutral});
  section.blocks.emplace_back(calibration_table(bench));
  section.blocks.emplace_back(case_table(bench));
  page.sections.push_back(std::move(section));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::experiments
