#include "judged_history.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace touchstone::dashboard {

std::size_t JudgedHistory::failures() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(all, [](const JudgedSeries& judged) { return judged.verdict.failed(); }));
}

bool JudgedHistory::failed() const { return failures() > 0; }

const JudgedSeries* JudgedHistory::worst() const {
  const JudgedSeries* best = nullptr;
  for (const auto& judged : all) {
    const auto rank = [](const JudgedSeries& j) { return std::pair(j.verdict.failed(), j.series.points.size()); };
    if (best == nullptr || rank(judged) > rank(*best)) best = &judged;
  }
  return best;
}

std::string JudgedHistory::text() const {
  std::string text = failed()
                         ? fmt::format("{} of {} series failed.\n", failures(), all.size())
                         : fmt::format("No limit is broken and nothing has become worse in {} series.\n", all.size());
  for (const auto& judged : all) {
    if (all.size() == 1 || !judged.verdict.findings.empty()) text += series_text(judged, all.size() == 1);
  }
  return text + fmt::format("{} series; false alarms: at most {:.3g} % per year of daily builds, of all together\n",
                            all.size(), 100.0 * false_alarms_per_year);
}

JudgedHistory judge_history(std::vector<HistorySeries> series, const HistoryLimits& limits) {
  JudgedHistory history;
  history.false_alarms_per_year = limits.false_alarms_per_year;
  for (auto& one : series) {
    auto verdict = judge_series(one, limits.of(one.key), limits.false_alarms_per_year, series.size());
    if (one.points.empty()) verdict.findings.push_back({"there is no value to judge", true, std::nullopt});
    history.all.push_back({std::move(one), std::move(verdict)});
  }
  return history;
}

std::string series_text(const JudgedSeries& judged, bool values) {
  std::string text = title_of(judged.series.key) + "\n";
  std::vector<std::string> notes(judged.series.points.size());
  for (const auto& finding : judged.verdict.findings) {
    if (finding.change) notes[judged.verdict.report.changes[*finding.change].index] += "   " + finding.sentence;
  }
  for (std::size_t i = 0; i < judged.series.points.size() && values; ++i)
    text +=
        fmt::format("  {:<24} {:>14.8g}{}\n", judged.series.points[i].commit, judged.series.points[i].value, notes[i]);
  for (const auto& finding : judged.verdict.findings)
    text += fmt::format("  {}: {}\n", finding.fails ? finding.change ? "change" : "gate" : "note", finding.sentence);
  std::size_t steps = 0;
  for (const auto& change : judged.verdict.report.changes)
    steps += change.kind == change_points::ChangeKind::step ? 1 : 0;
  text += fmt::format("  values: {}; steps: {}; drifts: {}: {}\n", judged.series.points.size(), steps,
                      judged.verdict.report.changes.size() - steps, judged.verdict.failed() ? "FAILED" : "passed");
  return text;
}

}  // namespace touchstone::dashboard
