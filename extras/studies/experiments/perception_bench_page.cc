#include "experiments/perception_bench_page.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/published_cases.h"
#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"
#include "harness/stats/quantile.h"

namespace touchstone::experiments {
using report::Section;
using report::Table;
using report::Tone;

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

Table score_table(const PerceptionBench& bench, std::string caption) {
  Table table;
  table.caption = std::move(caption);
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

Table calibration_table(const PerceptionBench& bench, std::string caption, std::string truth) {
  Table table;
  table.caption = std::move(caption);
  table.columns = {"stated between", "cases", "stated", std::move(truth), "simulated observers"};
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

// The judge's d' beside that of each experiment: medians over setups and seeds.
Table experiment_table(const PerceptionBench& published) {
  Table table;
  table.caption = "The judge against published experiments";
  table.columns = {"experiment", "just noticeable there", "source", "procedure",
                   "d' there",   "d' judged at 1/4",      "at 1",   "at 3"};
  const auto& experiments = published_experiments();
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    Table::Row row;
    row.cells = {{std::string(experiments[e].name), false, Tone::neutral},
                 {std::string(experiments[e].found), false, Tone::neutral},
                 {std::string(experiments[e].source), false, Tone::neutral},
                 {std::string(experiments[e].procedure), false, Tone::neutral},
                 {fmt::format("{:.2f}", experiments[e].criterion_d), true, Tone::neutral}};
    for (const double times : {0.25, 1.0, 3.0}) {
      std::vector<double> judged;
      for (const auto& run : published.runs) {
        for (const auto& own : run.cases) {
          if (own.reference == e && std::abs(own.literature - times * experiments[e].criterion_d) < 1e-9)
            judged.push_back(own.d_prime);
        }
      }
      row.cells.push_back({fmt::format("{:.2f}", stats::median(judged)), true, Tone::neutral});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

// The bars in one look, for both kinds of truth.
Table bar_table(const PerceptionBench& bench, const PerceptionBench& published) {
  Table table;
  table.caption = "The judge's bars";
  table.columns = {"what", "bar", "by the judge's thresholds", "by published experiments"};
  const auto row = [&](const char* what, const char* bar, const auto& text_of) {
    Table::Row own;
    own.cells = {{what, false, Tone::neutral},
                 {bar, false, Tone::neutral},
                 {text_of(bench), true, Tone::neutral},
                 {text_of(published), true, Tone::neutral}};
    table.rows.push_back(std::move(own));
  };
  const auto of = [](std::size_t part, std::size_t all) {
    return fmt::format("{} of {} ({:.1f} %)", part, all, 100.0 * share(part, all));
  };
  row("clear pairs (d' more than 2 apart) ordered rightly", "99 %",
      [&](const PerceptionBench& b) { return of(b.scores.front().right, b.scores.front().pairs); });
  row("cases below threshold (d' < 0.5) called indistinguishable", "95 %",
      [&](const PerceptionBench& b) { return of(b.called_indistinguishable, b.below_threshold); });
  row("largest miscalibration of the stated probabilities", "0.05",
      [](const PerceptionBench& b) { return fmt::format("{:.3f}", b.largest_miscalibration); });
  row("95 % intervals that hold the d'", "-", [&](const PerceptionBench& b) { return of(b.covered, b.cases); });
  return table;
}

Section published_section(const PerceptionBench& published) {
  Section section;
  section.title = "Against experiments on people";
  section.intro =
      "The planted difference is a quarter, one and three times what a published experiment found just noticeable; the "
      "judge's thresholds do not enter the answer. Three stiffnesses, presses up to 8 N.";
  section.blocks.emplace_back(experiment_table(published));
  section.blocks.emplace_back(
      score_table(published, "Clear pairs ordered as published experiments say, and those of a repeat against each"));
  section.blocks.emplace_back(report::TextBlock{
      fmt::format(
          "Below threshold (d' < 0.5): {} of {} are called indistinguishable. The 95 % interval holds the experiment's "
          "d' in {:.1f} % of {} cases. Largest miscalibration over bins of 20 cases or more: {:.3f}.",
          published.called_indistinguishable, published.below_threshold,
          100.0 * share(published.covered, published.cases), published.cases, published.largest_miscalibration),
      Tone::neutral});
  section.blocks.emplace_back(
      calibration_table(published, "Probabilities against simulated observers who feel what the experiments found",
                        "by the experiments"));
  return section;
}

nlohmann::ordered_json bench_json(const PerceptionBench& bench);

}  // namespace

std::string perception_bench_to_json(const PerceptionBench& bench, const PerceptionBench& published) {
  nlohmann::ordered_json document{{"schema", "touchstone-perception-bench/2"}};
  document["thresholds"] = bench_json(bench);
  document["experiments"] = bench_json(published);
  nlohmann::ordered_json experiments = nlohmann::ordered_json::array();
  for (const auto& own : published_experiments()) {
    experiments.push_back({{"name", own.name},
                           {"just_noticeable", own.found},
                           {"source", own.source},
                           {"procedure", own.procedure},
                           {"criterion_d_prime", own.criterion_d}});
  }
  document["experiments"]["sources"] = experiments;
  return document.dump(1) + "\n";
}

namespace {

nlohmann::ordered_json bench_json(const PerceptionBench& bench) {
  nlohmann::ordered_json document{{"first_seed", bench.options.first_seed},
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
  document["runs"] = bench_runs_to_json(bench.runs);
  return document;
}

}  // namespace

std::string perception_bench_table(const PerceptionBench& bench) {
  std::vector<std::vector<std::string>> rows{{"metric", "clear pairs", "ordered rightly", "undefined"}};
  for (const auto& score : bench.scores) {
    rows.push_back({score.metric, fmt::format("{}", score.pairs),
                    fmt::format("{:.1f} %", 100.0 * share(score.right, score.pairs)),
                    fmt::format("{:.1f} %", 100.0 * share(score.undefined, score.pairs))});
  }
  std::string text = report::align_columns(rows);
  text += fmt::format(
      "below threshold (d' < 0.5): {} of {} called indistinguishable; intervals hold the literature's d' "
      "in {:.1f} % of {} cases; largest miscalibration {:.3f}\n",
      bench.called_indistinguishable, bench.below_threshold, 100.0 * share(bench.covered, bench.cases), bench.cases,
      bench.largest_miscalibration);
  return text;
}

report::Page perception_bench_page(const PerceptionBench& bench, const PerceptionBench& published,
                                   const report::Provenance& provenance) {
  report::Page page;
  page.title = "Perception: every metric on planted differences";
  page.subtitle = fmt::format("{} setups, seeds {} to {}", bench_setups().size(), bench.options.first_seed,
                              bench.options.first_seed + bench.options.seeds - 1);
  Section section;
  section.title = "Which metric orders what people tell apart?";
  section.intro =
      "Presses on a simulated spring with one planted difference each. The d' that each should have follows "
      "from the planted number and the judge's own thresholds. A pair is clear if the two d' are more than 2 apart.";
  section.blocks.emplace_back(bar_table(bench, published));
  section.blocks.emplace_back(score_table(
      bench,
      "Clear pairs ordered as the literature's thresholds say, and those of a repeat against each kind of difference"));
  section.blocks.emplace_back(report::TextBlock{
      fmt::format("Below threshold (d' < 0.5): {} of {} are called indistinguishable. The 95 % interval holds "
                  "the literature's d' in {:.1f} % of the {} cases.",
                  bench.called_indistinguishable, bench.below_threshold, 100.0 * share(bench.covered, bench.cases),
                  bench.cases),
      Tone::neutral});
  section.blocks.emplace_back(calibration_table(
      bench, "Stated probabilities against simulated observers who feel the planted difference", "by the thresholds"));
  section.blocks.emplace_back(case_table(bench));
  page.sections.push_back(std::move(section));
  page.sections.push_back(published_section(published));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::experiments
