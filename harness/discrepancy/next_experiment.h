// The trajectory that would separate equal explanations: the motions a hand can make at the place already scanned,
// and the one on which the explanations' predicted forces differ most beyond the noise: the sensor's, and where they
// touch the tracker's, which the stiffness turns into force.
#pragma once

#include <optional>
#include <string>

#include "harness/discrepancy/effect_search.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

struct NextExperiment {
  MotionColumns motion;     // positions, and orientations where the recording has them; 250 Hz
  std::string what;         // "free air, the tool turned about x and y by 40 degrees"
  double separation = 0.0;  // RMS over samples and axes of the predicted forces' difference over the noise
};

// Nothing when no motion of the repertoire separates the two models by one and a half times the noise: less than the
// noise counts as indistinguishable, and refitting takes some of the difference.
std::optional<NextExperiment> propose_experiment(const recording::Recording& recording,
                                                 const rendering::Prediction& prediction, const rendering::Model& one,
                                                 const rendering::Model& other, const rendering::MakePredictor& make,
                                                 double force_noise_N, double position_noise_m);

}  // namespace touchstone::discrepancy
