#include "harness/report/history_formats.h"

#include <array>

namespace touchstone::report {
namespace {

constexpr auto history_fields = std::to_array<FormatField>({
    {"false_alarms_per_year?", "number", "", "of all series together; 0.01 by default"},
    {"limits", "list of objects", "", "the first that matches a series counts"},
    {"limits[].metric?", "text", "", "pattern; without it every one matches"},
    {"limits[].test?", "text", "", "pattern"},
    {"limits[].site?", "text", "", "pattern"},
    {"limits[].build?", "text", "", "pattern"},
    {"limits[].track?", "text", "", "pattern"},
    {"limits[].worse?", "text", "", "up, down or any"},
    {"limits[].smallest_relative?", "number", "1", "smallest change that matters, of the level before it"},
    {"limits[].smallest_absolute?", "number", "metric's unit", "smallest change that matters"},
    {"limits[].max?", "number", "metric's unit", "largest value allowed"},
    {"limits[].min?", "number", "metric's unit", "least value allowed"},
    {"limits[].max_rise?", "number", "1", "of the newest value over the median of those before"},
    {"limits[].max_fall?", "number", "1", "the same downwards"},
    {"limits[].accepted?", "list of objects", "", "changes that are meant"},
    {"limits[].accepted[].commit", "text", "", "that they came with"},
    {"limits[].accepted[].reason", "text", "", "why"},
});

constexpr auto history_verdict_fields = std::to_array<FormatField>({
    {"failed", "flag", "", "any series fails"},
    {"series", "list of objects", "", "one for each metric of each test"},
    {"series[].site", "text", "", "where it ran"},
    {"series[].build", "text", "", "name of the build"},
    {"series[].track", "text", "", "of the dashboard"},
    {"series[].test", "text", "", "name"},
    {"series[].metric", "text", "", "name"},
    {"series[].exact", "flag", "", "without noise: every difference is a change"},
    {"series[].values", "list of objects", "", "oldest first"},
    {"series[].values[].commit", "text", "", "hash"},
    {"series[].values[].time", "text or whole number", "", "when it ran"},
    {"series[].values[].value", "number or null", "metric's unit", "value"},
    {"series[].changes", "list of objects", "", "that were found"},
    {"series[].changes[].kind", "text", "", "step or drift"},
    {"series[].changes[].index", "whole number", "", "first value after it"},
    {"series[].changes[].first", "whole number", "", "first value that it may lie at"},
    {"series[].changes[].last", "whole number", "", "last one"},
    {"series[].changes[].before", "number or null", "metric's unit", "level before"},
    {"series[].changes[].after", "number or null", "metric's unit", "level after"},
    {"series[].changes[].p", "number or null", "1", "probability by chance"},
    {"series[].findings", "list of objects", "", "what was said"},
    {"series[].findings[].sentence", "text", "", "in words"},
    {"series[].findings[].fails", "flag", "", "it fails the series"},
    {"series[].failed", "flag", "", "any finding fails"},
});

}  // namespace

std::span<const FileFormat> history_file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-history/1", "history-limits.json",
       "limits of metrics over builds, and changes that were accepted (docs/how-to/history.md)", "",
       "`history --limits`", history_fields},
      {"touchstone-history-verdict/1", "FILE of `history --json`",
       "metrics over builds, their changes, and which of them fail", "`history`", "", history_verdict_fields},
  });
  return formats;
}

}  // namespace touchstone::report
