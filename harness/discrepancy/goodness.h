// Whether noise can be what a model leaves.
//
// A tip that moves less than its tracker's noise hides the path over which friction turns: the fit then prefers a
// longer one, which smooths the noise, and that model's own noise says too little of what a shorter one does to the
// measured force. Where the fitted model leaves too much, it is judged by the noise of the same friction over a shorter
// path.
#pragma once

#include "harness/discrepancy/evidence.h"

namespace touchstone::discrepancy {

struct Goodness {
  double chi_squared = 0.0;  // held out, per degree of freedom, of the model under its noise; 1: only noise
  double null = 0.0;         // the same in the worst null world
  // From here on the residual is not noise: a share above the largest of the case's simulated null recordings, in
  // which the model is the truth. They are few, and idealize: under dry friction a tip that sticks and slips with the
  // tracker's noise leaves up to twice of what they make, and it takes more there.
  double threshold = 0.0;
  // What a flexible regression predicts (see structure_detector.h) counts where more than this is left.
  double structured_threshold = 0.0;
  // Where more than this is left, a law is worth seeking: without dry friction what no simulated recording leaves.
  double law_threshold = 0.0;
  double noise_rms_N = 0.0;  // 3-D force error that noise leaves on the held-out samples
  FitData train;             // blocks under the noise that it was judged by
  FitData holdout;
};

Goodness judge_goodness(const Evidence& train, const Evidence& holdout, const rendering::Model& model, double window_s);

}  // namespace touchstone::discrepancy
