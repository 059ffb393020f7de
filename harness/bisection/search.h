// Which commits changed a metric: the metric as a function of the commits is estimated, and nothing is called bad by a
// threshold. Each interval between measured commits with a change that matters is divided in its middle, the one with
// the largest change first (binary search for several change points at once). It is not divided further where the
// change is spread evenly over many intervals in a row: that is drift, of which no single commit is the cause. Within
// drift, an interval with more than its neighbours' rate is divided on: a step inside the drift.
//
// What matters: a change of at least `least_share` of the whole, or what the noise lets be seen with `most_runs` runs
// per commit. Each commit is run so often that a change that matters stands six standard errors clear; the decision
// lies in the middle. What is named is measured again on both sides before it is named with confidence.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "harness/bisection/commit_curve.h"

namespace touchstone::bisection {

struct SearchOptions {
  double least_share = 0.05;   // of the change between the ends
  double least_change = 0.0;   // in the metric's unit
  std::size_t end_runs = 9;    // of either end, unless its first two runs give the same value on both
  std::size_t most_runs = 25;  // of one commit in the search
  std::size_t parallel = 1;    // commits that are built at once
};

struct MeasureRequest {
  std::size_t position = 0;
  std::size_t runs = 1;  // in addition to those that are there
};

// A commit that changed the metric.
struct Step {
  std::size_t before = 0;   // the last measured position before the change
  std::size_t at = 0;       // the first after it; before + 1 unless all between are broken
  double change = 0.0;      // across it
  double excess = 0.0;      // the same without the drift around it
  double error = 0.0;       // standard error of the change
  double share = 0.0;       // excess over the change between the ends
  double confidence = 0.0;  // that this commit and no noise made the change: 1 - p, corrected for all commits searched
  [[nodiscard]] bool single() const noexcept { return at == before + 1; }
  // Measured on both sides, and at least 99 % confident.
  [[nodiscard]] bool sure() const noexcept { return single() && confidence >= 0.99; }
};

// A change that is spread over commits (first, last], none of which is its cause.
struct Drift {
  std::size_t first = 0;
  std::size_t last = 0;
  double change = 0.0;   // without the steps inside
  double share = 0.0;    // of the change between the ends
  double largest = 0.0;  // no commit in it holds more than this
};

struct SearchFindings {
  double good = 0.0;  // levels of the ends
  double bad = 0.0;
  double noise = 0.0;        // of one run
  double end_error = 0.0;    // standard error of bad - good
  bool ends_differ = false;  // else nothing was searched
  double matters = 0.0;      // smallest change that was looked for
  std::vector<Step> steps;   // by position
  std::vector<Drift> drifts;
  double unexplained_share = 0.0;  // of the whole: 1 minus those of steps and drifts
};

// What to measure next; nothing: the search is at its end. Depends on the curve alone, so that a search that was
// stopped goes on from what it had measured.
std::vector<MeasureRequest> next_requests(const CommitCurve& curve, const SearchOptions& options);

// What is known so far.
SearchFindings conclude(const CommitCurve& curve, const SearchOptions& options);

}  // namespace touchstone::bisection
