// What a run of a golden case is judged by: its columns, the figures of a loop, the width of the tolerance, the exact
// answer, the operations, what a person notices. Each is one function over what ran and what it is held against,
// beside what it computes with; judges() has them in the order in which they are asked. A judge adds its sentences to
// the problems of the comparison and its numbers to the figures, and makes the verdict worse where it must. None makes
// it better but the exact answer, which turns `worse` into `better` where the run is nearer to it than the golden is.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "harness/golden/case_runner.h"
#include "harness/golden/comparison/trajectory_columns.h"

namespace touchstone::golden {

// A model of a case: what the case says, and what runs in its place.
struct CaseModel {
  std::string name;
  rendering::Model own;
  rendering::Model runs;
};

struct JudgedRun {
  const Catalogues& catalogues;
  const GoldenCase& golden;
  const CaseModel& model;
  const CaseCheck& options;
  const CaseRun& run;
  const TrajectoryColumns& obtained;
  TrajectoryColumns& expected;  // the golden's; the columns take from `obtained` what is another answer, and as right
};

struct Judge {
  std::string_view of;
  bool needs_golden;  // asked only where there is a golden, and it can be read
  void (*judge)(const JudgedRun& judged, CheckResult& result);
};

std::span<const Judge> judges();

// Beside their computations.
void judge_loop(const JudgedRun& judged, CheckResult& result);             // loop_case.cc
void judge_by_exact_answer(const JudgedRun& judged, CheckResult& result);  // exact_error.cc
void judge_felt(const JudgedRun& judged, CheckResult& result);             // felt_verdict.cc

}  // namespace touchstone::golden
