// The verdict `felt`: would a person notice the difference from the right answer? Beside the verdict `exact` (the
// tolerance of the golden case), for engines that are right but for an epsilon.
#pragma once

#include <cstddef>
#include <string>

#include "harness/golden/case_runner.h"
#include "harness/recording/trajectory.h"

namespace touchstone::golden {

struct FeltError {
  std::string reference;      // "exact", "golden", or "both": what the samples were judged by
  std::size_t by_exact = 0;   // samples
  std::size_t by_golden = 0;  // samples; what is in neither has no right answer that is known
  double mean_N = 0.0;        // of the magnitude of the error, as are the next two
  double rms_N = 0.0;
  double max_N = 0.0;
  double jump_N = 0.0;   // the largest change of the error from one judged sample to the next
  double right_N = 0.0;  // the largest right force
  double max_jnd = 0.0;
  double worst_t_s = 0.0;
  bool passed = false;
};

// The run against the exact answer of the smooth body behind the case's mesh: a frictionless god-object's or spring's,
// with the case's own stiffness and tip. Of the difference is taken off, before it is counted in just noticeable
// differences (a fingertip's, harness/perception/filters/weber_law.h):
//   k epsilon      what the engine declares
//   k |q' - q|     q and q' the points of the smooth body and of the mesh that are closest to the tip: the engine was
//                  given the mesh. At most k (b + sqrt(8 b depth)) with b the tessellation's deviation bound: points of
//                  a mesh within b of the body that are no farther from the tip than depth + b lie that close to q, if
//                  the depth is at most half of the radius of curvature.
// Where the right force jumps from one sample to the next by more than the tolerance (the foot passes a sharp edge),
// the run may have either: engines that move their proxy by one constraint per step show the jump a sample later, and
// nobody feels which of the two samples had it.
// The exact answer knows no path. From where the tip leaves the sheet on which it touched (Generators::leaves_sheet)
// until it is free, and where no exact answer is known, the golden is the right answer, with k epsilon taken off alone.
// Throws BadData where no sample can be judged.
FeltError felt_error(const Catalogues& catalogues, const GoldenCase& golden, const std::string& model,
                     const recording::RenderedTrajectory& run, const FeltTolerance& tolerance);
std::string to_sentence(const FeltError& error, const FeltTolerance& tolerance);

}  // namespace touchstone::golden
