// Many series of a history judged together, in words and in order of what fails.
#pragma once

#include <string>
#include <vector>

#include "history.h"
#include "history_page.h"
#include "history_verdict.h"

namespace touchstone::dashboard {

struct JudgedHistory {
  std::vector<JudgedSeries> all;       // in the order of the series
  double false_alarms_per_year = 0.0;  // of daily builds, of all series together

  [[nodiscard]] bool failed() const;                // any of them
  [[nodiscard]] std::size_t failures() const;       // how many
  [[nodiscard]] const JudgedSeries* worst() const;  // that failed first, then the longest; null without any
  // For people. One series whole, with its values; of many, those with something to say.
  [[nodiscard]] std::string text() const;
};

// Each series by the limit that matches it. A series without a value fails: a limit that sees nothing guards nothing.
JudgedHistory judge_history(std::vector<HistorySeries> series, const HistoryLimits& limits);

// A line per value (with `values`) and per finding, and how many steps and drifts there are.
std::string series_text(const JudgedSeries& judged, bool values);

}  // namespace touchstone::dashboard
