#include "harness/report/console.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"
#include "harness/report/metric_json.h"
#include "harness/report/quantity.h"

namespace touchstone::report {
namespace {

// Columns on a terminal are characters, not bytes: continuation bytes of UTF-8 take no room.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

std::string align_columns(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  }
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string gap(widths[i] - width_of(row[i]), ' ');
      line += i == 0 ? row[i] + gap : "  " + gap + row[i];
    }
    out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    if (&row == &rows.front()) {
      std::size_t total = 0;
      for (const std::size_t width : widths) total += width + 2;
      out += std::string(total - 2, '-') + "\n";
    }
  }
  return out;
}

std::string console_table(
    const std::vector<std::pair<std::string, const std::vector<metrics::MetricResult>*>>& evaluations) {
  std::vector<std::vector<std::string>> rows{{"metric"}};
  for (const auto& [name, metrics] : evaluations) rows.front().push_back(name);
  if (evaluations.empty()) return "";
  const auto& first = *evaluations.front().second;
  for (std::size_t i = 0; i < first.size(); ++i) {
    std::vector<std::string> row{first[i].name};
    for (const auto& [name, metrics] : evaluations) {
      if (metrics->size() != first.size() || (*metrics)[i].name != first[i].name) {
        throw UsageError(fmt::format("\"{}\" has other metrics than \"{}\"", name, evaluations.front().first));
      }
      const metrics::MetricResult& metric = (*metrics)[i];
      row.push_back(metric.status == metrics::MetricStatus::ok ? display_quantity(metric.value, metric.unit)
                                                               : status_name(metric.status));
    }
    rows.push_back(std::move(row));
  }
  return align_columns(rows);
}

}  // namespace touchstone::report
