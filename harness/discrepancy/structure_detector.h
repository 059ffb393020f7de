// Whether what a model leaves has structure that noise has not: flexible regressions of the residual, one for each view
// (see residual_views.h), learnt on the training blocks and judged on the held-out ones. They may detect, and are never
// added to a model.
//
// Many views find something by chance. So each is judged by what it predicts in simulated recordings, in which the
// model is the truth and was fitted again, and the bar of all is the largest standardized share that any view reaches
// in any of those (the max statistic of joint tests: Westfall and Young 1993, chapter 2). Beyond chance the
// share must matter: laws of a library are idealized, and what they leave of a true effect's details is no missing
// effect.
#pragma once

#include <string>
#include <vector>

#include "harness/discrepancy/joint_fit.h"
#include "harness/discrepancy/noise_model.h"
#include "harness/discrepancy/parameter_intervals.h"

namespace touchstone::discrepancy {

struct Structure {
  std::string view;    // the one that exceeds its bar most, or comes nearest
  double gain = 0.0;   // of held-out chi-squared
  double share = 0.0;  // of the held-out chi-squared, at the recorded and on the smoothed positions: the lesser
  double bar = 0.0;    // of the share
  [[nodiscard]] bool found() const { return share > bar; }
};

struct DetectorSide {
  const recording::Recording* recording = nullptr;
  const FitData* blocks = nullptr;  // of the part that counts, with its noise under `model`
  NoiseModel* noise = nullptr;
};

// `refits`: `model` fitted again to null recordings; without one it stands for itself.
Structure detect_structure(const DetectorSide& train, const DetectorSide& holdout, const rendering::Model& model,
                           const std::vector<NullFit>& refits);

}  // namespace touchstone::discrepancy
