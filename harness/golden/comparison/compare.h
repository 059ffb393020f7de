// Compares what was obtained with a golden, column by column and row by row. Two verdicts are kept apart: drift (some
// bit differs, which a compiler's flags can cause) and accuracy (beyond tolerance). Every comparison is written so that
// only a proven agreement passes: `!(error <= bound)` rather than `error > bound`.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "harness/golden/comparison/tolerance.h"
#include "harness/golden/comparison/trajectory_columns.h"
#include "harness/golden/comparison/verdict.h"

namespace touchstone::golden {

// A limit on the whole run.
struct Gate {
  std::string name;  // "rms_N"
  double value;
  double limit;
  [[nodiscard]] bool passed() const noexcept { return value <= limit; }
};

// The error of one quantity, in its SI unit; the error of a sample is the Euclidean length of the difference, for an
// orientation the angle between the two.
struct GroupResult {
  Quantity quantity = Quantity::time;
  std::string group;  // its name
  std::string unit;
  Verdict verdict = Verdict::equal;
  double rms = 0.0;
  double p99 = 0.0;
  double max = 0.0;
  double peak = 0.0;                 // of the golden
  std::size_t beyond = 0;            // samples that break the per-sample bound
  std::size_t drift = 0;             // samples in which some bit differs
  double tolerance_used = 0.0;       // the largest of error over bound and of gate value over limit; 1 is the limit
  std::array<double, 4> axis_rms{};  // per column
  std::size_t worst_row = 0;
  std::vector<double> worst_expected;
  std::vector<double> worst_obtained;
  std::vector<Gate> gates;
};

// Contact events (the contact column changes) of both sides, in order.
struct ContactEvents {
  std::size_t expected = 0;
  std::size_t obtained = 0;
  double max_shift_s = 0.0;   // over events paired by order; NaN where they cannot be paired
  double mean_shift_s = 0.0;  // signed, positive is later than the golden
};

struct Comparison {
  Verdict verdict = Verdict::equal;
  std::size_t expected_rows = 0;
  std::size_t obtained_rows = 0;
  std::size_t drift = 0;  // rows in which some bit differs
  std::vector<GroupResult> groups;
  ContactEvents events;
  std::vector<std::string> problems;  // what makes it missing or invalid, one sentence each
  bool bad_data = false;  // one side alone is unusable: not finite, empty, a column twice or of unequal length

  [[nodiscard]] const GroupResult* find(std::string_view group) const noexcept;
  [[nodiscard]] double tolerance_used() const noexcept;
};

Comparison compare(const TrajectoryColumns& expected, const TrajectoryColumns& obtained, const Tolerance& tolerance);

}  // namespace touchstone::golden
