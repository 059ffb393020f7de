// Reads measurements back from a CDash server, by its GraphQL interface (every build of a project) or by the interface
// behind its test graphs (one test of one build, and its earlier runs under the same site, name and track).
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cdash_server.h"
#include "history.h"

namespace touchstone::dashboard {

// The series of the wanted keys (matches()). A build without Update.xml has no revision: its points are called
// "build N". Throws BadData when the server cannot be reached, refuses, does not know the project or hides it from this
// token, or answers with something else.
std::vector<HistorySeries> cdash_history(CdashConnection& connection, const SeriesKey& wanted);

// Through api/v1/testGraph.php, which takes the name of the test, not its number. Its points carry no revision.
HistorySeries cdash_test_graph(CdashConnection& connection, const std::string& build_id, const std::string& test,
                               const std::string& metric);

// One page of GraphQL's answer, added to `map`; returns where the next page begins, nothing after the last. `url`, the
// server's, is for messages. Throws BadData for an answer that CDash does not give.
std::optional<std::string> read_history_page(const nlohmann::json& answer, const std::string& url,
                                             const SeriesKey& wanted,
                                             std::map<SeriesKey, std::vector<HistoryPoint>>& map);

// The answer of testGraph.php, oldest first. Throws BadData likewise.
std::vector<HistoryPoint> read_test_graph(const nlohmann::json& answer, const std::string& url);

}  // namespace touchstone::dashboard
