#include "history.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <set>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"

namespace touchstone::dashboard {
namespace {

using SeriesMap = std::map<SeriesKey, std::vector<HistoryPoint>>;

std::vector<HistorySeries> in_order(SeriesMap map) {
  std::vector<HistorySeries> all;
  for (auto& [key, points] : map) {
    const bool timed = std::ranges::all_of(points, [](const HistoryPoint& p) { return !p.time.empty(); });
    if (timed) std::ranges::stable_sort(points, {}, &HistoryPoint::time);  // ISO 8601 sorts as text
    all.push_back({key, std::move(points)});
  }
  return all;
}

void read_lines(const std::filesystem::path& file, const SeriesKey& wanted, std::set<std::string>& seen,
                SeriesMap& map) {
  std::ifstream in(file);
  if (!in) throw BadData(fmt::format("{}: cannot be opened for reading", file.string()));
  std::set<std::string> here;
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string place = fmt::format("{}: line {}", file.string(), number);
    // A parser counts the lines of what it reads: of a bad one those before it, too.
    if (!nlohmann::json::accept(line)) parse_json(std::string(number - 1, '\n') + line, file.string());
    const nlohmann::json document = nlohmann::json::parse(line);
    JsonObject object(document, place, "");
    const auto text = [&](const char* name) { return object.optional_text(name).value_or(""); };
    const SeriesKey key{text("site"), text("build"), text("track"), text("test"), object.text("metric")};
    HistoryPoint point{object.text("commit"), text("time"), object.number("value")};
    object.finish();
    // Equal lines of one file are repeated measurements; of two files, the same one fetched twice.
    if (seen.contains(line)) continue;
    here.insert(line);
    if (matches(wanted, key)) map[key].push_back(std::move(point));
  }
  seen.merge(here);
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
    if (entry.is_regular_file() && entry.path().extension() == ".jsonl") files.push_back(entry.path());
  }
  if (files.empty()) throw BadData(fmt::format("{}: no *.jsonl file is in this folder or below", path.string()));
  std::ranges::sort(files);
  return files;
}

std::string utc_time(std::time_t seconds) {
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday,
                     parts.tm_hour, parts.tm_min, parts.tm_sec);
}

}  // namespace

std::string title_of(const SeriesKey& key) {
  std::string title = key.metric;
  if (!key.test.empty()) title += " of " + key.test;
  const std::string where = key.site + (key.site.empty() || key.build.empty() ? "" : "/") + key.build;
  if (!where.empty()) title += ", " + where;
  if (!key.track.empty()) title += ", " + key.track;
  return title;
}

bool matches_name(const std::string& pattern, const std::string& name) {
  if (pattern.empty()) return true;
  if (pattern.back() == '*') return name.starts_with(std::string_view(pattern).substr(0, pattern.size() - 1));
  return pattern == name;
}

bool matches(const SeriesKey& pattern, const SeriesKey& key) {
  return matches_name(pattern.site, key.site) && matches_name(pattern.build, key.build) &&
         matches_name(pattern.track, key.track) && matches_name(pattern.test, key.test) &&
         matches_name(pattern.metric, key.metric);
}

std::vector<HistorySeries> load_history(const std::vector<std::filesystem::path>& files, const SeriesKey& wanted) {
  SeriesMap map;
  std::set<std::string> seen;
  for (const auto& path : files) {
    for (const auto& file : files_of(path)) read_lines(file, wanted, seen, map);
  }
  return in_order(std::move(map));
}

void append_history(const std::filesystem::path& file, const std::vector<HistorySeries>& series) {
  std::string text;
  for (const auto& [key, points] : series) {
    for (const HistoryPoint& point : points) {
      if (!std::isfinite(point.value))
        throw BadData(fmt::format("{} of {} is {}: not recorded", key.metric, point.commit, point.value));
      nlohmann::json line{{"commit", point.commit}, {"metric", key.metric}, {"value", point.value}};
      const auto add = [&](const char* name, const std::string& value) {
        if (!value.empty()) line[name] = value;
      };
      add("test", key.test);
      add("site", key.site);
      add("build", key.build);
      add("track", key.track);
      add("time", point.time);
      text += line.dump() + "\n";
    }
  }
  append_locked(file, text);
}

CollectedRun collect_ctest(const std::filesystem::path& testing, const std::string& commit) {
  std::ifstream tag(testing / "TAG");
  std::string stamp;
  std::getline(tag, stamp);
  const auto file = testing / stamp / "Test.xml";
  pugi::xml_document document;
  if (stamp.empty() || !document.load_file(file.c_str()))
    throw BadData(fmt::format("{0}: no readable Test.xml of a run: run the tests by ctest --test-dir {1} -T Test",
                              testing.string(), testing.parent_path().empty() ? "." : testing.parent_path().string()));
  const auto site = document.child("Site");
  const std::string build_stamp = site.attribute("BuildStamp").value();
  const auto dash = build_stamp.find('-', build_stamp.find('-') + 1);
  const std::string time = utc_time(site.child("Testing").child("StartTestTime").text().as_llong());
  SeriesMap map;
  CollectedRun run;
  for (const auto& test : site.child("Testing").children("Test")) {
    for (const auto& measured : test.child("Results").children("NamedMeasurement")) {
      const std::string_view name = measured.attribute("name").value();
      const std::string_view value = measured.child_value("Value");
      if (std::string_view(measured.attribute("type").value()) != "numeric/double" || name == "Execution Time" ||
          name == "Processors")
        continue;
      double number = 0.0;
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
      if (error != std::errc{} || end != value.data() + value.size() || !std::isfinite(number)) {
        run.not_numbers.push_back(fmt::format("{}: {} = {}", test.child_value("Name"), name, value));
        continue;
      }
      map[{site.attribute("Name").value(), site.attribute("BuildName").value(),
           dash == std::string::npos ? "" : build_stamp.substr(dash + 1), test.child_value("Name"), std::string(name)}]
          .push_back({commit, time, number});
    }
  }
  run.series = in_order(std::move(map));
  return run;
}

}  // namespace touchstone::dashboard
