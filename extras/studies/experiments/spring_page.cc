#include "experiments/spring_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/perception/published_tables.h"
#include "harness/report/evaluation_page.h"
#include "harness/report/perception_page.h"
#include "harness/stats/quantile.h"

namespace touchstone::experiments {
using report::Section;
using report::Table;
using report::Tone;

namespace {

namespace pc = perception;

Table::Cell percent(const Share& own) { return {fmt::format("{:.0f} %", 100.0 * own.value()), true, Tone::neutral}; }

// A finding holds where it held in nearly every seed, fails where in nearly none, and else depends on chance.
Table::Cell share_cell(const Share& own) {
  const Tone tone = own.low95() > 0.9 ? Tone::good : (own.high95() < 0.1 ? Tone::error : Tone::warning);
  Table::Cell cell = percent(own);
  cell.tone = tone;
  return cell;
}

// The first cell of a row: what the paper says.
Table::Row finding_row(std::size_t finding) {
  Table::Row row;
  row.cells.push_back(report::text_cell(spring_findings()[finding].statement));
  return row;
}

Section findings_section(const SpringExperiment& e) {
  Section section{
      "Which findings hold here",
      fmt::format("Share of {} seeds (from {}) in which each statement of the paper is true, by what the paper leaves "
                  "open: the rule that scales features, and the set-up. Set apart in one colour where surely above "
                  "90 %, in another where surely below 10 % (95 % interval), in a third between.",
                  e.seeds, e.first_seed),
      {},
      false};
  const auto& findings = spring_findings();
  for (const auto& own : e.variants) {
    Table table;
    table.caption = fmt::format("{}: {}", own.variant.name, own.variant.what);
    table.columns = {"finding of the paper"};
    for (const auto scaling : pc::feature_scalings) table.columns.emplace_back(pc::name_of(scaling));
    for (std::size_t f = 0; f < findings.size(); ++f) {
      Table::Row row = finding_row(f);
      for (const auto& share : own.findings[f]) row.cells.push_back(share_cell(share));
      while (row.cells.size() < table.columns.size()) row.cells.push_back(report::text_cell(""));
      table.rows.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

Section why_section(const SpringExperiment& e) {
  Section section{
      "Why",
      "A weak device cuts the force. Where the linear spring needs more than the device can give, that takes from its "
      "likeness; where the quadratic law overshoots the real spring, it takes from the excess and brings it nearer, in "
      "the perception space and in newtons alike. The correlation does not see an excess, only that the shape is cut "
      "flat. The tables show each feature alone: which of them carries a finding, and how far every condition lies "
      "from "
      "the real spring in it (mean over the seeds; a distance of 1 is as large as the feature of the real spring).",
      {},
      false};
  const auto& findings = spring_findings();
  for (const auto& own : e.variants) {
    Table table;
    table.caption = own.variant.name + ": share of seeds in which the finding is true by one feature alone";
    table.columns = {"finding of the paper"};
    for (const auto& feature : own.features) table.columns.push_back(feature);
    for (std::size_t f = 0; f < findings.size(); ++f) {
      if (!findings[f].uses_space) continue;
      Table::Row row = finding_row(f);
      for (std::size_t b = 0; b < own.features.size(); ++b) row.cells.push_back(share_cell(own.by_feature[b][f]));
      table.rows.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(table));
    Table means;
    means.caption = own.variant.name + ": mean distance to the real spring";
    means.columns = {"condition", "perception space"};
    for (const auto& feature : own.features) means.columns.push_back(feature);
    means.columns.emplace_back("Euclidean distance [N]");
    for (std::size_t c = 0; c < e.conditions.size(); ++c) {
      Table::Row row;
      row.cells = {report::text_cell(e.conditions[c]), report::number_cell(own.mean_distance[0][c])};
      for (std::size_t b = 0; b < own.features.size(); ++b)
        row.cells.push_back(report::number_cell(own.mean_block_distance[b][c]));
      row.cells.push_back(report::number_cell(own.mean_statistic[0][c]));
      means.rows.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(means));
  }
  return section;
}

Section scan_section(const SpringExperiment& e) {
  Section section{
      "How it depends on the force of the press",
      fmt::format("Share of {} seeds in which a finding holds, over the force of the real spring at the full stroke; "
                  "features scaled by the rule reference-norm. Touch saturates at 3.3 N, Touch X at 7.9 N, Omega.7 "
                  "at 12 N.",
                  e.scan.front().findings.front().of),
      {},
      false};
  for (const auto rule : {QuadraticRule::equal_at_full_stroke, QuadraticRule::same_number}) {
    Table table;
    table.caption = rule == QuadraticRule::same_number ? "F = k dx^2 with the same number for k"
                                                       : "F = k dx^2 with the same force at the full stroke";
    table.columns = {"finding of the paper"};
    for (const auto& point : e.scan) {
      if (point.rule == rule) table.columns.push_back(fmt::format("{:g} N", point.full_stroke_force_N));
    }
    for (std::size_t f = 0; f < spring_findings().size(); ++f) {
      Table::Row row = finding_row(f);
      for (const auto& point : e.scan) {
        // No tones: so few seeds make nothing sure.
        if (point.rule == rule) row.cells.push_back(percent(point.findings[f]));
      }
      table.rows.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

// The first statistics are the columns of table 3.
Table table_of_the_paper(const SpringExperiment& e) {
  const VariantResult& base = e.variants.front();
  Table table;
  table.caption = "As tables 2 and 3 of the paper: base, mean over the seeds (as printed there).";
  table.columns = {"condition",           "distance in perception space", "Euclidean distance [N]",
                   "Pearson correlation", "Euclidean, filtered [N]",      "Pearson, filtered"};
  for (std::size_t c = 0; c < e.conditions.size(); ++c) {
    const auto& printed = pc::published::published_conditions[c];
    const double theirs[] = {printed.distance, printed.euclidean, printed.pearson, printed.euclidean_filtered,
                             printed.pearson_filtered};
    Table::Row row;
    row.cells = {report::text_cell(e.conditions[c])};
    for (std::size_t i = 0; i < std::size(theirs); ++i) {
      const double here = i == 0 ? base.mean_distance[0][c] : base.mean_statistic[i - 1][c];
      row.cells.push_back({fmt::format("{:.4g} ({:.4f})", here, theirs[i]), true, Tone::neutral});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Section agreement_table(const SpringExperiment& e) {
  Section section{
      "Agreement with the published order",
      "Spearman's rank correlation of every method with the order of likeness that the paper's ten subjects gave "
      "(its figure 12 and table 2): median over the seeds, and the range that holds 95 % of them. Six conditions: "
      "0.89 is the 5 % point of no correlation.",
      {},
      false};
  Table table;
  table.columns = {"method"};
  for (const auto& own : e.variants) table.columns.push_back(own.variant.name);
  const auto& methods = e.variants.front().methods;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    Table::Row row;
    row.cells.push_back(report::text_cell(methods[m]));
    for (const auto& own : e.variants) {
      auto sorted = own.agreement[m];
      std::sort(sorted.begin(), sorted.end());
      const auto at = [&](double share) {
        return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
      };
      row.cells.push_back(
          {fmt::format("{:.2f} ({:.2f} to {:.2f})", stats::median(sorted), at(0.025), at(0.975)), true, Tone::neutral});
    }
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  section.blocks.emplace_back(table_of_the_paper(e));
  Table published;
  published.caption = "The same from the paper's own tables 2 and 3.";
  published.columns = {"method", "Spearman's rho"};
  std::vector<double> space, euclidean, pearson, euclidean_filtered, pearson_filtered, likeness;
  for (const auto& own : pc::published::published_conditions) {
    space.push_back(own.distance);
    euclidean.push_back(own.euclidean);
    pearson.push_back(own.pearson);
    euclidean_filtered.push_back(own.euclidean_filtered);
    pearson_filtered.push_back(own.pearson_filtered);
    likeness.push_back(-static_cast<double>(likeness.size()));
  }
  const auto add = [&](const std::string& name, const std::vector<double>& values, bool larger_is_better) {
    const auto own = pc::agree(name, values, larger_is_better, likeness).spearman;
    published.rows.push_back(
        {{report::text_cell(name),
          {fmt::format("{:.2f}, p = {:.3f}", own.coefficient, own.p_two_sided), true, Tone::neutral}},
         "",
         {}});
  };
  add("distance in perception space (table 2)", space, false);
  add("Euclidean distance (table 3)", euclidean, false);
  add("Pearson correlation (table 3)", pearson, true);
  add("Euclidean distance after filtering (table 3)", euclidean_filtered, false);
  add("Pearson correlation after filtering (table 3)", pearson_filtered, true);
  section.blocks.emplace_back(std::move(published));
  return section;
}

Section setup_section(const SpringExperiment& e) {
  const SpringSetup& setup = e.variants.front().variant.setup;
  Section section{
      "Set-up", "Devices from the paper's table 1. What it does not give is ours, and is said so.", {}, true};
  section.blocks.emplace_back(report::Facts{
      {{"real spring (ours)",
        fmt::format("{} N/m, {} mm stroke", setup.stiffness_N_per_m, 1e3 * setup.motion.stroke_m)},
       {"presses (ours)", fmt::format("{} at {} Hz; stroke {:.0f} %, onset {} ms standard deviation; tremor {} mm RMS",
                                      setup.motion.presses, setup.motion.beat_Hz, 100.0 * setup.motion.stroke_spread,
                                      1e3 * setup.motion.onset_spread_s, 1e3 * setup.motion.tremor_m)},
       {"force sensor (ours)", fmt::format("noise {} N, step {} N", setup.force_noise_N, setup.force_step_N)},
       {"distance module under the real spring (ours)", fmt::format("noise {} mm", 1e3 * setup.distance_noise_m)},
       {"rate", fmt::format("{} Hz as in the paper; simulated at {} Hz", setup.rate_Hz, setup.simulation_rate_Hz)},
       {"servo period and time constant (ours)",
        "Omega.7 0.25 ms and 1.5 ms, Touch X 1 ms and 4 ms, Touch 1 ms and 8 ms"},
       {"observers", "simulated, who feel the distances of the perception space: they show the method, not people"}}});
  for (const auto& condition : spring_conditions(setup)) {
    section.blocks.emplace_back(report::Code{condition.name, model_to_json(condition.model)});
  }
  return section;
}

}  // namespace

report::Page spring_page(const SpringExperiment& e, const report::Provenance& provenance) {
  report::Page page;
  page.title = "The spring experiment";
  page.subtitle = "Shao, Wu and Ouyang's comparison of two spring models on three devices, on simulated presses";
  const auto& base = e.variants.front();
  for (std::size_t f = 0; f < 4; ++f) {
    const Share& own = base.findings[f][0];
    page.headlines.push_back({spring_findings()[f].name, fmt::format("{:.0f}", 100.0 * own.value()), "%",
                              fmt::format("of {} seeds; {}", own.of, spring_findings()[f].statement),
                              share_cell(own).tone});
  }
  page.sections.push_back(findings_section(e));
  page.sections.push_back(why_section(e));
  page.sections.push_back(scan_section(e));
  page.sections.push_back(agreement_table(e));
  for (auto& section : report::perception_result_sections(e.example)) {
    section.title = "One run: " + section.title;
    page.sections.push_back(std::move(section));
  }
  auto people = report::agreement_section(e.example, e.simulated_subjects);
  people.title = "One run: simulated observers";
  page.sections.push_back(std::move(people));
  for (auto& section : report::perception_signal_sections(e.example)) page.sections.push_back(std::move(section));
  page.sections.push_back(setup_section(e));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::experiments
