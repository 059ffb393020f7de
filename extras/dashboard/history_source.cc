#include "history_source.h"

#include <cstdlib>

#include "cdash_history.h"
#include "harness/base/error.h"

namespace touchstone::dashboard {

HistorySource source_from_environment(HistorySource source, bool look) {
  if (look && !source.given()) {
    const char* const local = std::getenv("TOUCHSTONE_HISTORY");
    if (local != nullptr && *local != '\0') source.local.emplace_back(local);
    source.cdash = source.local.empty() && !cdash_from_environment(source.server).url.empty();
    if (!source.given()) return source;
  }
  if (!source.local.empty() == source.cdash) throw UsageError("give either --local FILE or --cdash [URL]");
  if (source.cdash) {
    source.server = cdash_from_environment(source.server);
    if (source.server.url.empty()) throw UsageError("--cdash needs the address of a server, or TOUCHSTONE_CDASH_URL");
  }
  return source;
}

std::vector<HistorySeries> load_series(const HistorySource& source) {
  if (!source.cdash) return load_history(source.local, source.wanted);
  CdashConnection connection(source.server);
  if (source.build_id.empty()) return cdash_history(connection, source.wanted);
  if (source.wanted.test.empty() || source.wanted.metric.empty())
    throw UsageError("--build-id needs --test and --metric");
  return {cdash_test_graph(connection, source.build_id, source.wanted.test, source.wanted.metric)};
}

}  // namespace touchstone::dashboard
