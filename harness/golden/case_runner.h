// Runs golden cases: makes the case's world from the catalogues, replays, compares with the golden, and leaves behind
// what a person needs to judge a failure.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "harness/golden/catalogues.h"
#include "harness/golden/comparison/compare.h"
#include "harness/golden/golden_case.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/model.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::golden {

struct FeltError;      // felt_verdict.h
struct LoopFigures;    // loop_case.h
struct RunOperations;  // golden_summary.h

// The case's object and motion, from its files or made by generators; every length times `scale`, the motion `speed`
// times as fast.
surface::TriangleMesh case_mesh(const rendering::Generators& generators, const CaseSurface& surface, double scale);
recording::InTrajectory case_trajectory(const rendering::Generators& generators, const CaseTrajectory& wanted,
                                        double scale, double speed);
inline surface::TriangleMesh case_mesh(const rendering::Generators& generators, const GoldenCase& golden) {
  return case_mesh(generators, golden.surface, golden.scale);
}
inline recording::InTrajectory case_trajectory(const rendering::Generators& generators, const GoldenCase& golden) {
  return case_trajectory(generators, golden.trajectory, golden.scale, golden.speed);
}

// A model of the case. What it names lies in the case's own folder: a picture elsewhere throws BadData with its place.
// Throws UsageError with the names that there are for another one.
rendering::Model case_model(const GoldenCase& golden, const std::string& name);

struct CaseRun {
  recording::RenderedTrajectory rendered;
  std::map<std::string, std::string> provenance;    // as golden_file.h names it
  double p99_us = 0.0;                              // of a step
  std::shared_ptr<const surface::Surface> surface;  // of one object; empty for a scene
  std::shared_ptr<const LoopFigures> loop;          // of a case that closes one
  std::shared_ptr<const RunOperations> operations;  // where the renderer's are counted
};

// Changes a case's model before it runs.
using ChangeModel = std::function<void(rendering::Model&)>;

// Throws BadData when the case cannot run, or the renderer answers with a number that is not finite.
CaseRun run_case(const Catalogues& catalogues, const GoldenCase& golden, const std::string& model, bool time_steps,
                 const ChangeModel& change = {});

// For the verdict `felt`: would a person notice the difference from the right answer (felt_verdict.h)?
struct FeltTolerance {
  double jnd = 1.0;        // the largest error, in just noticeable differences of the right force
  double epsilon_m = 0.0;  // what the engine says it cannot tell apart; times the stiffness it is allowed on top
};

struct CheckResult {
  Comparison comparison;
  std::string table;                                    // for people, with why it could not run where that is so
  std::vector<std::pair<std::string, double>> figures;  // of the judges (judges.h), by the name of the measurement
  bool drift_fails = false;                             // bits differ, and that was asked to fail
  std::shared_ptr<const FeltError> felt;                // where the verdict `felt` was asked for and the case ran
  std::string skipped;            // the reason that the renderer declares for what the case demands; else empty
  std::filesystem::path left_in;  // the folder of a failure, else empty
  std::string measurements;       // and pictures, for ctest where they were asked for

  [[nodiscard]] bool passed() const;
};

struct CaseCheck {
  std::filesystem::path out;  // for what failures leave behind
  bool ctest = false;         // measure, with the time of the steps
  ChangeModel change = {};
  std::optional<FeltTolerance> felt = std::nullopt;  // judge by what a person would notice
  bool fail_on_drift = false;  // bits that differ fail where the golden was made on a processor like this one
};

// One model of a case against its golden. Beyond tolerance but nearer to the exact answer is `better`, which does not
// pass either: it is news, and becomes the golden by a person's decision. So are operations that are not the golden's,
// which are held against it as long as the model is the case's own. What does not pass leaves obtained.h5, table.txt,
// comparison.json and pictures in `out`/<case>/<model>; what passes removes what an earlier failure left.
// Where the case's renderer pushes to the closest surface point, another point that is as close passes
// (equal_answers.h).
// Skipped is a case that says nothing about a renderer in the place of the case's own: its tip is another one, or the
// run starts inside the body and the renderer declares that it cannot.
CheckResult check_case(const Catalogues& catalogues, const GoldenCase& golden, const std::string& model,
                       const CaseCheck& options);

}  // namespace touchstone::golden
