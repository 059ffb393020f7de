#include "cdash_history.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "harness/base/error.h"

namespace touchstone::dashboard {
namespace {

using nlohmann::json;
using SeriesMap = std::map<SeriesKey, std::vector<HistoryPoint>>;

// CDash hands numbers out as text or as numbers; what is not a finite number is no measurement.
std::optional<double> number_of(const json& value) {
  double number = 0.0;
  if (value.is_number()) {
    number = value.get<double>();
  } else if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  } else {
    return std::nullopt;
  }
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

// A name that stands for one only can be asked for; one with a star is sorted out here.
std::string filter(const char* field, const std::string& name) {
  if (name.empty() || name.back() == '*') return "";
  return fmt::format("(filters: {{eq: {{{}: {}}}}})", field, graphql_text(name));
}

// One page of builds; filters keep the answer small on servers with many tests.
std::string query_of(const std::string& project, const SeriesKey& wanted, const std::string& after) {
  std::string tests = filter("name", wanted.test);
  tests = tests.empty() ? "(first: 100000)" : "(first: 100000, " + tests.substr(1);
  return fmt::format(
      "{{ project(name: {}) {{ builds(first: 50{}) {{ edges {{ node {{ id name stamp startTime buildType "
      "site {{ name }} updateStep {{ revision }} tests{} {{ edges {{ node {{ name status "
      "testMeasurements{} {{ name value }} }} }} }} }} }} pageInfo {{ hasNextPage endCursor }} }} }} }}",
      graphql_text(project), after.empty() ? "" : ", after: " + graphql_text(after), tests,
      filter("name", wanted.metric));
}

void add_build(const json& build, const SeriesKey& wanted, SeriesMap& map) {
  const auto& update = build.at("updateStep");
  const bool known = update.is_object() && update.at("revision").is_string();
  const std::string commit =
      known ? update.at("revision").get<std::string>() : "build " + build.at("id").get<std::string>();
  for (const auto& edge : build.at("tests").at("edges")) {
    const json& test = edge.at("node");
    for (const auto& measured : test.at("testMeasurements")) {
      const SeriesKey key{build.at("site").at("name"), build.at("name"), build.at("buildType"), test.at("name"),
                          measured.at("name")};
      const auto value = number_of(measured.at("value"));
      if (value && matches(wanted, key)) map[key].push_back({commit, build.at("startTime"), *value});
    }
  }
}

}  // namespace

std::optional<std::string> read_history_page(const json& answer, const std::string& url, const SeriesKey& wanted,
                                             SeriesMap& map) {
  try {
    const json& builds = answer.at("project").at("builds");
    for (const auto& edge : builds.at("edges")) add_build(edge.at("node"), wanted, map);
    const json& page = builds.at("pageInfo");
    if (!page.at("hasNextPage").get<bool>()) return std::nullopt;
    return page.at("endCursor").get<std::string>();
  } catch (const json::exception& error) {
    throw BadData(fmt::format("{}: the answer is not what CDash's GraphQL gives: {}", url, error.what()));
  }
}

std::vector<HistorySeries> cdash_history(CdashConnection& connection, const SeriesKey& wanted) {
  const CdashServer& server = connection.server();
  SeriesMap map;
  std::optional<std::string> after = "";
  while (after) {
    const json answer = connection.graphql(query_of(server.project, wanted, *after));
    if (answer.contains("project") && answer["project"].is_null())
      throw BadData(fmt::format("{}: there is no project '{}' that this token may see", server.url, server.project));
    const std::string before = *after;
    after = read_history_page(answer, server.url, wanted, map);
    if (after == before) throw BadData(fmt::format("{}: the server gives the same page again and again", server.url));
  }
  std::vector<HistorySeries> all;
  for (auto& [key, points] : map) {
    std::ranges::stable_sort(points, {}, &HistoryPoint::time);  // ISO 8601 in one zone sorts as text
    all.push_back({key, std::move(points)});
  }
  return all;
}

HistorySeries cdash_test_graph(CdashConnection& connection, const std::string& build_id, const std::string& test,
                               const std::string& metric) {
  const std::string path =
      fmt::format("/api/v1/testGraph.php?buildid={}&testname={}&type=measurement&measurementname={}",
                  percent_encoded(build_id), percent_encoded(test), percent_encoded(metric));
  return {{"", "", "", test, metric}, read_test_graph(connection.get(path), connection.server().url)};
}

std::vector<HistoryPoint> read_test_graph(const json& answer, const std::string& url) {
  std::vector<std::pair<double, HistoryPoint>> points;
  try {
    for (const auto& point : answer.at(0).at("data")) {
      const auto value = number_of(point.at("y"));
      const double milliseconds = point.at("x").get<double>();
      if (value)
        points.push_back(
            {milliseconds,
             {"test run " + point.at("buildtestid").dump(), fmt::format("{:.0f}", milliseconds / 1e3), *value}});
    }
  } catch (const json::exception& error) {
    throw BadData(fmt::format("{}: the answer is not what CDash's test graph gives: {}", url, error.what()));
  }
  std::ranges::stable_sort(points, {}, [](const auto& p) { return p.first; });
  std::vector<HistoryPoint> in_order;
  for (auto& [time, point] : points) in_order.push_back(std::move(point));
  return in_order;
}

}  // namespace touchstone::dashboard
