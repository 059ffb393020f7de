// Whether noise can be what a model leaves.
//
// A tip that moves less than its tracker's noise hides the path over which friction turns: the fit then prefers a
// longer one, which smooths the noise, and that model's own noise says too little of what a shorter one does to the
// measured force. Where the fitted model leaves too much, it is judged by the noise of the same friction over a shorter
// path.
#pragma once

#include "harness/discrepancy/evidence.h"

namespace touchstone {

struct Goodness {
  double chi_squared = 0.0;  // held out, per degree of freedom, of the model under its noise; 1: only noise
  double null = 0.0;         // the same in the worst null world
  double noise_rms_N = 0.0;  // 3-D force error that noise leaves on the held-out samples
  FitData train;             // blocks under the noise that it was judged by
  FitData holdout;
};

// Held-out chi-squared per degree of freedom above which noise cannot be what is left: twice what noise makes, and more
// where the case's own null worlds, in which the model is the truth, make more (a tip that sticks and slips with the
// tracker's noise).
inline constexpr double unexplained_goodness = 2.0;
inline constexpr double unexplained_over_null = 2.2;
double unexplained_threshold(double null_goodness);

Goodness judge_goodness(const Evidence& train, const Evidence& holdout, const Model& model, double window_s);

}  // namespace touchstone
