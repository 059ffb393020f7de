// Metrics over builds. A series is what one test measured at one site, under one build name, in one track: values of
// another machine, compiler or developer are another series and are never judged together.
#pragma once

#include <compare>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::dashboard {

struct SeriesKey {
  std::string site, build, track, test, metric;  // empty where the source does not say
  auto operator<=>(const SeriesKey&) const = default;
};

struct HistoryPoint {
  std::string commit;  // the revision; "build N" where the source does not know it
  std::string time;    // ISO 8601, or as the source has it; may be empty
  double value = 0.0;  // finite
};

struct HistorySeries {
  SeriesKey key;
  std::vector<HistoryPoint> points;  // oldest first
};

// "metric of test, site/build, track", without what is empty.
std::string title_of(const SeriesKey& key);

// Which series are wanted: empty fields take all; a final '*' takes every name that begins so.
bool matches(const SeriesKey& pattern, const SeriesKey& key);
bool matches_name(const std::string& pattern, const std::string& name);

// Files with one JSON object to a line: {"commit", "metric", "value" [, "test", "site", "build", "track", "time"]}.
// A folder stands for every *.jsonl file in it and below, such as artefacts fetched from a CI service; the same line in
// several files counts once. Points with times are put in their order. Throws BadData with file and line.
std::vector<HistorySeries> load_history(const std::vector<std::filesystem::path>& files, const SeriesKey& wanted);

// Adds one line for each series' points; throws BadData for a value that is not finite.
void append_history(const std::filesystem::path& file, const std::vector<HistorySeries>& series);

struct CollectedRun {
  // One series of one value for each measurement.
  std::vector<HistorySeries> series;
  // Measurements whose value is no finite number, as "test: metric = value": they are in no series.
  std::vector<std::string> not_numbers;
};

// Every numeric measurement of the newest run in `testing`, the folder Testing of a build: ctest's Test.xml, which
// `ctest -T Test` and the dashboard write. What ctest adds of its own (Execution Time, Processors) is no measurement.
// Throws BadData if there is no such file.
CollectedRun collect_ctest(const std::filesystem::path& testing, const std::string& commit);

}  // namespace touchstone::dashboard
