// The trajectory that would tell alike explanations apart: the motions a hand can make at the place already scanned,
// and the one on which the explanations' predicted forces differ most beyond the force noise.
#pragma once

#include <optional>
#include <string>

#include "harness/discrepancy/effect_search.h"

namespace touchstone {

struct NextExperiment {
  MotionColumns motion;     // positions, and orientations where the recording has them; 250 Hz
  std::string what;         // "free air, the tool turned about x and y by 40 degrees"
  double separation = 0.0;  // RMS difference of the predicted forces over the RMS force noise
};

// Nothing when no motion of the repertoire separates the two models by more than three times the noise.
std::optional<NextExperiment> propose_experiment(const Recording& recording, const Prediction& prediction,
                                                 const Model& one, const Model& other, const MakePredictor& make,
                                                 double force_noise_N);

}  // namespace touchstone
