#include <fmt/format.h>

#include <algorithm>

#include "harness/report/evaluation_page.h"
#include "tool_reports/tool_scorecard.h"

namespace touchstone::tool_reports {
namespace {

using report::number_cell;
using report::Page;
using report::Section;
using report::Table;
using report::text_cell;
using report::Tone;

Table::Cell finding_cell(const tool::ToolFinding& finding) {
  if (!finding.applies) return text_cell("not applicable: " + finding.why_not);
  Table::Cell cell = text_cell(fmt::format("{}{}: {:.3g} of {:.3g} {}", finding.passed ? "ok" : "WRONG",
                                           finding.fault.empty() ? "" : ", " + finding.fault, finding.measured,
                                           finding.limit, finding.unit));
  cell.tone = finding.passed ? Tone::good : Tone::error;
  return cell;
}

Section checks(std::span<const ToolScorecard> cards) {
  Section section{
      "What every renderer of a tool must do",
      "Small flat bodies whose answer follows from statics: measured, of the limit. A fault that explains a "
      "wrong answer is named.",
      {},
      false};
  Table table;
  table.columns = {"check"};
  std::vector<std::string> names;
  for (const ToolScorecard& card : cards) {
    table.columns.push_back(card.renderer);
    for (const tool::ToolFinding& finding : card.findings) {
      if (std::ranges::find(names, finding.check) == names.end()) names.push_back(finding.check);
    }
  }
  for (const std::string& name : names) {
    Table::Row row;
    row.cells.push_back(text_cell(name));
    for (const ToolScorecard& card : cards) {
      const auto found = std::ranges::find(card.findings, name, &tool::ToolFinding::check);
      row.cells.push_back(found == card.findings.end() ? text_cell("did not run") : finding_cell(*found));
    }
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  for (const ToolScorecard& card : cards) {
    for (const ToolProblem& problem : card.problems) {
      section.blocks.emplace_back(
          report::TextBlock{fmt::format("{}{}: {}", card.renderer,
                                        problem.contacts.empty() ? "" : ", case " + problem.contacts, problem.what),
                            Tone::warning});
    }
  }
  return section;
}

Section cases(std::span<const ToolScorecard> cards) {
  Section section{
      "Cases whose answer is known",
      "Force and torque at rest against the exact equilibrium without friction (with it: `touchstone tool table "
      "--slide`); a just noticeable difference (JND) of torque "
      "is 12.7 %, and 7.6 mNm below 60 mNm.",
      {},
      false};
  for (const ToolScorecard& card : cards) {
    Table table;
    table.caption = card.renderer;
    table.columns = {
        "case",      "force error, mean [N]", "max [N]", "torque error, mean [mNm]", "max [mNm]", "max [JND]",
        "force [N]", "torque [mNm]"};
    for (const tool::ToolErrors& e : card.errors) {
      Table::Row row;
      row.cells = {text_cell(e.contacts),
                   number_cell(e.mean_force_N, 2),
                   number_cell(e.max_force_N, 2),
                   number_cell(1e3 * e.mean_torque_Nm, 2),
                   number_cell(1e3 * e.max_torque_Nm, 2),
                   number_cell(e.max_torque_jnd, 2),
                   number_cell(e.largest_right_force_N, 3),
                   number_cell(1e3 * e.largest_right_torque_Nm, 3)};
      table.rows.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

Section costs(std::span<const ToolScorecard> cards) {
  Section section{"Cost of a step in contact", "A ball pressed into a ball, slid and turned at 1 kHz.", {}, false};
  Table table;
  table.columns = {"renderer", "triangles",  "contacts listed", "median [us]",
                   "p99 [us]", "p99.9 [us]", "made in [ms]",    "memory [MB]"};
  for (const ToolScorecard& card : cards) {
    if (!card.cost) continue;
    Table::Row row;
    row.cells = {
        text_cell(card.renderer),
        text_cell(fmt::format("{} on {}", card.cost->tool_triangles, card.cost->object_triangles)),
        number_cell(card.cost->contacts, 3),
        number_cell(card.cost->median_us, 3),
        number_cell(card.cost->p99_us, 3),
        number_cell(card.cost->p999_us, 3),
        number_cell(card.cost->build_ms, 3),
        card.cost->memory_bytes ? number_cell(1e-6 * double(*card.cost->memory_bytes), 3) : text_cell("unknown")};
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

}  // namespace

Page tool_scorecard_page(std::span<const ToolScorecard> cards, const report::Provenance& provenance) {
  Page page;
  page.title = "Scorecard of renderers of a tool";
  const auto wrong = std::ranges::count_if(cards, [](const ToolScorecard& card) { return !clean(card); });
  page.subtitle = wrong == 0 ? "nothing wrong was found"
                             : fmt::format("{} of {} renderers: something is wrong", wrong, cards.size());
  for (const ToolScorecard& card : cards) {
    const auto applies = std::ranges::count_if(card.findings, &tool::ToolFinding::applies);
    const auto right =
        std::ranges::count_if(card.findings, [](const tool::ToolFinding& f) { return f.applies && f.passed; });
    page.headlines.push_back(
        {card.renderer, fmt::format("{} of {}", right, applies), "checks",
         card.summary + " (" + card.source + ")" + (card.library.empty() ? "" : ", " + card.library),
         clean(card) ? Tone::good : Tone::error});
  }
  page.sections = {checks(cards), cases(cards)};
  if (std::ranges::any_of(cards, [](const ToolScorecard& card) { return card.cost.has_value(); }))
    page.sections.push_back(costs(cards));
  page.sections.push_back(report::provenance_section(provenance));
  return page;
}

}  // namespace touchstone::tool_reports
