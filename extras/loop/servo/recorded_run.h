// A run of the same renderer on a device (live.csv of `touchstone hil render`) beside its simulation: is what happens
// there what these figures of device and hand predict?
//
// The recording's clock is not the path's: it is shifted to where the recorded positions fit the simulated ones best.
// The recorded force is the one that acts; of the simulation, the one commanded a latency before.
#pragma once

#include "harness/recording/trajectory.h"
#include "servo/evaluation.h"

namespace touchstone::servo {

struct RecordedComparison {
  double device_mass_kg = 0.0;  // of the run that fits best
  double shift_s = 0.0;         // the recording's time plus this is the simulation's
  double compared_s = 0.0;
  // Root mean squares: of the recorded motion about its mean and of the recorded force, and of the differences.
  double motion_m = 0.0, difference_m = 0.0;
  double force_N = 0.0, difference_N = 0.0;
  double difference_jnd = 0.0;    // of the force, in just noticeable differences from the recorded one
  Vibration recorded, simulated;  // the largest of the force in contact
  bool agrees = false;            // the difference, and that of the vibrations, is less than is just noticed
  std::string sentence;
};

// Throws BadData for a recording without force, or one that the path does not cover: at least half of it must lie
// within the path's time.
RecordedComparison compare_recorded(const LoopEvaluation& evaluation, const LoopSetup& setup,
                                    const recording::Recording& recording, const perception::Thresholds& thresholds);

}  // namespace touchstone::servo
