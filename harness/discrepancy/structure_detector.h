// Whether what a model leaves has structure that noise has not: a flexible regression of the residual on the motion,
// its past and the contact, learnt on the training blocks and judged on the held-out ones. It may detect, and is never
// added to a model. All features turn with the world, and none has a unit of its own, so that the answer depends on
// neither.
#pragma once

#include "harness/discrepancy/joint_fit.h"
#include "harness/discrepancy/noise_model.h"

namespace touchstone {

struct Structure {
  double gain = 0.0;   // of held-out chi-squared
  double share = 0.0;  // of the held-out chi-squared, at the recorded positions and along the likely motion: the lesser
  double bar = 0.0;    // of the share, well above what the case's own null worlds give
  [[nodiscard]] bool found() const { return share > bar; }
};

struct DetectorSide {
  const Recording* recording = nullptr;
  const FitData* blocks = nullptr;  // of the part that counts, with its noise under `model`
  NoiseModel* noise = nullptr;
};

Structure detect_structure(const DetectorSide& train, const DetectorSide& holdout, const Model& model);

}  // namespace touchstone
