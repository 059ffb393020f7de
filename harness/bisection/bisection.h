// Which commits of a repository changed a metric: builds and measures what the search (search.h) asks for, follows
// merges into what they brought, and puts the answer together.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "harness/bisection/git_history.h"
#include "harness/bisection/measured_table.h"
#include "harness/bisection/search.h"

namespace touchstone::bisection {

// A commit that has been built, for whoever measures it.
struct BuiltCommit {
  std::string commit;
  std::filesystem::path source, build;
  std::filesystem::path work;                                    // a folder of this commit's own, kept
  std::vector<std::pair<std::string, std::string>> environment;  // SRC, BUILD, WORK, COMMIT
  std::filesystem::path log;
};
// The metric, or nothing when the commit cannot run it. Called from several threads.
using Measure = std::function<std::optional<double>(const BuiltCommit& built, const std::atomic<bool>& stop)>;

struct BisectionRequest {
  std::string metric;
  std::string good, bad;      // full names
  std::string build_command;  // for sh, in $SRC, into $BUILD
  // What is measured and of what, to the byte: measurements that are kept in `out` count for the same question alone.
  std::string question;
  Measure measure;
  SearchOptions search;
  std::filesystem::path out;  // logs, table, worktrees while it runs; one search at a time (SearchLock)
  std::function<void(const std::string&)> say;
};

struct NamedStep {
  Step step;
  std::vector<std::string> commits;  // the one; more when those between are broken
  std::string title;                 // of the last of them
  std::string merge;                 // by which it came; empty for one on the line itself
  bool by_merging = false;           // a merge whose branches do not explain the change
};

struct NamedDrift {
  Drift drift;
  std::string first, last;  // the first commit after the drift began, the last of it
};

struct MeasuredLine {
  std::vector<std::string> commits;
  CommitCurve curve;
};

struct BisectionAnswer {
  std::string metric;
  SearchFindings findings;
  MeasuredLine line;
  std::vector<NamedStep> steps;
  std::vector<NamedDrift> drifts;
  std::size_t builds = 0;
  std::size_t broken = 0;
};

// Throws BadData when an end cannot be measured, Interrupted when `stop` becomes true.
BisectionAnswer bisect(const GitHistory& history, const BisectionRequest& request, const std::atomic<bool>& stop);

}  // namespace touchstone::bisection
