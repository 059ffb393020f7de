#include "harness/report/cdash_history.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "harness/base/error.h"
#include "harness/base/web_request.h"

namespace touchstone {
namespace {

using nlohmann::json;

constexpr long first_error_status = 400;

// One page of builds; filters keep the answer small on servers with many tests.
constexpr const char* query = R"(query($project: String!, $test: String!, $after: String) {
  project(name: $project) { builds(first: 50, after: $after) {
    edges { node { id name startTime updateStep { revision }
      tests(filters: {eq: {name: $test}}) { edges { node { testMeasurements { name value } } } } } }
    pageInfo { hasNextPage endCursor } } } })";

json fetch(const CdashServer& server, const std::string& path, const std::optional<std::string>& body) {
  WebRequest request{.url = server.url + path, .headers = {"Content-Type: application/json"}, .body = body};
  if (!server.token.empty()) request.headers.push_back("Authorization: Bearer " + server.token);
  const WebAnswer got = web_request(request);
  if (got.outcome != WebOutcome::answered) throw BadData(fmt::format("{}: {}", server.url, got.problem));
  if (got.status >= first_error_status)
    throw BadData(fmt::format("{}: the server answers {}: {}", server.url, got.status, got.text.substr(0, 300)));
  json answer = json::parse(got.text, nullptr, false);
  if (answer.is_discarded())
    throw BadData(fmt::format("{}: the answer is not JSON; is this a CDash server?", server.url));
  return answer;
}

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

void add_build(const json& build, const std::string& metric, History& history) {
  for (const auto& test : build.at("tests").at("edges")) {
    for (const auto& measured : test.at("node").at("testMeasurements")) {
      const auto value = number_of(measured.at("value"));
      if (measured.at("name") != metric || !value) continue;
      const auto& update = build.at("updateStep");
      const std::string commit =
          update.is_object() && update.at("revision").is_string() ? update.at("revision") : build.at("name");
      history.push_back({commit, build.at("startTime"), *value});
    }
  }
}

}  // namespace

History cdash_history(const CdashServer& server, const std::string& project, const std::string& test,
                      const std::string& metric) {
  History history;
  json after = nullptr;
  try {
    for (bool more = true; more;) {
      const json body{{"query", query}, {"variables", {{"project", project}, {"test", test}, {"after", after}}}};
      const json answer = fetch(server, "/graphql", body.dump());
      if (answer.contains("errors"))
        throw BadData(fmt::format("{}: {}", server.url, answer["errors"].dump().substr(0, 300)));
      const json& found = answer.at("data").at("project");
      if (found.is_null())
        throw BadData(fmt::format("{}: there is no project '{}' that this token may see", server.url, project));
      for (const auto& edge : found.at("builds").at("edges")) add_build(edge.at("node"), metric, history);
      const json& page = found.at("builds").at("pageInfo");
      more = page.at("hasNextPage").get<bool>();
      after = page.at("endCursor");
    }
  } catch (const json::exception& error) {
    throw BadData(fmt::format("{}: the answer is not what CDash's GraphQL gives: {}", server.url, error.what()));
  }
  std::ranges::stable_sort(history, {}, &HistoryPoint::time);  // ISO 8601 sorts as text
  return history;
}

History cdash_test_graph(const CdashServer& server, const std::string& build_id, const std::string& test_id,
                         const std::string& metric) {
  const json answer =
      fetch(server,
            fmt::format("/api/v1/testGraph.php?testid={}&buildid={}&type=measurement&measurementname={}", test_id,
                        build_id, percent_encoded(metric)),
            std::nullopt);
  std::vector<std::pair<double, HistoryPoint>> points;
  try {
    for (const auto& point : answer.at(0).at("data")) {
      const auto value = number_of(point.at("y"));
      const double milliseconds = point.at("x").get<double>();
      if (value)
        points.push_back(
            {milliseconds, {point.at("buildtestid").dump(), fmt::format("{:.0f}", milliseconds / 1e3), *value}});
    }
  } catch (const json::exception& error) {
    throw BadData(fmt::format("{}: the answer is not what CDash's test graph gives: {}", server.url, error.what()));
  }
  std::ranges::stable_sort(points, {}, [](const auto& p) { return p.first; });
  History history;
  for (auto& [time, point] : points) history.push_back(std::move(point));
  return history;
}

}  // namespace touchstone
