#include "fuzz/read_structured_cdash.h"

#include <cmath>
#include <cstdlib>
#include <map>
#include <vector>

#include "cdash_history.h"
#include "cdash_parts.h"
#include "harness/base/error.h"
#include "harness/testing/damaged_json.h"

namespace touchstone::dashboard::fuzz {
namespace {

// As CDash 5.3's GraphQL schema (graphql/schema.graphql) and app/cdash/app/Controller/Api/TestGraph.php lay them out.
const char* const answers[] = {
    R"({"project": {"builds": {"edges": [
      {"node": {"id": "7", "name": "gcc", "stamp": "20261101-0100-Nightly", "startTime": "2026-11-01T01:00:00+00:00",
        "buildType": "Nightly", "site": {"name": "lab"}, "updateStep": {"revision": "0123abcd"},
        "tests": {"edges": [{"node": {"name": "check.sphere", "status": "PASSED",
          "testMeasurements": [{"name": "force_rms_N", "value": "0.01"}, {"name": "text", "value": "words"}]}}]}}},
      {"node": {"id": "8", "name": "gcc", "stamp": "20261102-0100-Nightly", "startTime": "2026-11-02T01:00:00+00:00",
        "buildType": "Nightly", "site": {"name": "lab"}, "updateStep": null,
        "tests": {"edges": [{"node": {"name": "check.sphere", "status": "PASSED",
          "testMeasurements": [{"name": "force_rms_N", "value": "0.02"}]}}]}}}],
      "pageInfo": {"hasNextPage": true, "endCursor": "abc"}}}})",
    R"([{"label": "force_rms_N", "data": [{"x": 1730000000000, "y": "0.5", "buildtestid": 3, "buildid": 7}]}])",
    R"({"updateStep": {"revision": "0123"}, "configure": {"id": "1"}, "buildErrorsCount": 0,
      "tests": {"pageInfo": {"total": 51}}, "dynamicAnalyses": {"pageInfo": {"total": 0}},
      "files": {"pageInfo": {"total": 1}}, "urls": {"pageInfo": {"total": 0}}, "notes": {"pageInfo": {"total": 1}},
      "coverage": {"pageInfo": {"total": 0}}})"};

std::size_t checked(const std::vector<HistoryPoint>& points) {
  for (const HistoryPoint& point : points) {
    if (!std::isfinite(point.value)) std::abort();
  }
  return points.size();
}

std::size_t read(std::size_t which, const nlohmann::json& answer) {
  std::size_t count = 0;
  try {
    if (which == 0) {
      std::map<SeriesKey, std::vector<HistoryPoint>> map;
      (void)read_history_page(answer, "fuzz", {}, map);
      for (const auto& [key, points] : map) count += checked(points);
    } else if (which == 1) {
      count += checked(read_test_graph(answer, "fuzz"));
    } else {
      using enum PartKind;
      for (const PartKind kind : {update, configure, build, test, coverage, memory_check, notes, upload})
        (void)remote_rows(answer, {.kind = kind, .name = "", .file_name = "", .xml = "", .rows = 1});
      ++count;
    }
  } catch (const BadData&) {
    return 0;
  }
  return count;
}

}  // namespace

std::size_t read_structured_cdash(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    std::size_t count = 0;
    for (std::size_t which = 0; which < std::size(answers); ++which)
      count += read(which, nlohmann::json::parse(answers[which]));
    return count;
  }
  testing::Choices choices({data, size});
  const std::size_t which = choices.below(std::size(answers));
  return read(which, testing::damaged_json(nlohmann::json::parse(answers[which]), choices));
}

}  // namespace touchstone::dashboard::fuzz
