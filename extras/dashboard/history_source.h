// Where the series of a history are read from: files of lines, or a CDash server.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cdash_server.h"
#include "history.h"

namespace touchstone::dashboard {

struct HistorySource {
  std::vector<std::filesystem::path> local;  // files, or folders of them
  bool cdash = false;                        // in their place `server`
  CdashServer server;
  std::string build_id;  // through the server's test graph of this build; wanted then names a test and a metric
  SeriesKey wanted;

  [[nodiscard]] bool given() const { return cdash || !local.empty(); }
};

// With `look`, a source that is not given is looked for: TOUCHSTONE_HISTORY, then TOUCHSTONE_CDASH_URL; it may stay not
// given. What of a server is not given comes from the environment (cdash_from_environment()). Throws UsageError where
// files and a server are given, neither is without `look`, or the server has no address.
HistorySource source_from_environment(HistorySource source, bool look);

// Throws UsageError for a build without test and metric, BadData as load_history() and cdash_history() do.
std::vector<HistorySeries> load_series(const HistorySource& source);

}  // namespace touchstone::dashboard
