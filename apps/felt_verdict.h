// The verdict `felt`: would a person notice the difference from the right answer? Beside the verdict `exact` (the
// tolerance of the golden case), for engines that are right but for an epsilon.
#pragma once

#include <string>

#include "harness/base/rooms.h"
#include "harness/baseline/golden_case.h"
#include "harness/recording/trajectory.h"

namespace touchstone::apps {

struct FeltTolerance {
  double jnd = 1.0;        // the largest error, in just noticeable differences of the right force
  double epsilon_m = 0.0;  // what the engine says it cannot tell apart; times the stiffness it is allowed on top
};

struct FeltError {
  std::string reference;  // "exact": the smooth body's answer is known; "golden": the mesh's alone
  double rms_N = 0.0;
  double max_N = 0.0;
  double max_jnd = 0.0;
  double worst_t_s = 0.0;
  bool passed = false;
};

// The run against the exact answer of the smooth body behind the case's mesh (a frictionless god-object's or spring's,
// with the case's own stiffness and tip), where one is known, and against the golden, which is right on the mesh:
// sample by sample what is nearer counts, as facets are not the engine's fault and a smooth answer knows no path. Just
// noticeable differences are a fingertip's (harness/perception/filters/weber_law.h). Throws BadData where neither is
// known.
FeltError felt_error(const GoldenCase& golden, const std::string& model, const RenderedTrajectory& run,
                     const FeltTolerance& tolerance);
std::string to_sentence(const FeltError& error, const FeltTolerance& tolerance);

}  // namespace touchstone::apps
