// Reads a measurement's history back from a CDash server, by its GraphQL interface (every build of a project) or by the
// interface behind its test graphs (one test of one build, and its earlier runs).
#pragma once

#include <string>

#include "harness/report/history.h"

namespace touchstone {

struct CdashServer {
  std::string url;    // http(s)://host/path, without a trailing slash
  std::string token;  // empty for an open project; goes into a header only
};

// The builds in which the test has the measurement, oldest first. Throws BadData when the server cannot be reached,
// refuses, does not know the project, or answers with something else.
History cdash_history(const CdashServer& server, const std::string& project, const std::string& test,
                      const std::string& metric);
// Through api/v1/testGraph.php.
History cdash_test_graph(const CdashServer& server, const std::string& build_id, const std::string& test_id,
                         const std::string& metric);

}  // namespace touchstone
