// A history as a picture, as JSON, and as a page that opens offline.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "harness/report/gnuplot.h"
#include "history.h"
#include "history_verdict.h"

namespace touchstone::dashboard {

struct JudgedSeries {
  HistorySeries series;
  SeriesVerdict verdict;
};

// The values as dots and each level as a line of its own: horizontal, or sloped where it drifts. Nothing is drawn
// between levels.
report::Plot history_plot(const JudgedSeries& judged);

// {"schema": "touchstone-history-verdict/1", "failed", "series": [{"site", ..., "values": [...], "changes": [...],
//  "findings": [...], "failed"}]}
nlohmann::json history_json(const std::vector<JudgedSeries>& all);

// Failed series first. Nothing is fetched from elsewhere.
std::string history_page(const std::vector<JudgedSeries>& all, const std::string& title);

}  // namespace touchstone::dashboard
