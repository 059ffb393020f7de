// The path along which a model is replayed to be judged. A model answers to every jitter of the positions with its
// stiffness, the object itself does not: on the recorded path the very model that made the recording would buzz.
//
// The path is smoothed by a local parabola (Savitzky and Golay 1964), over the longest window up to 20 ms whose
// residual is no more than the tracker's noise: the rule of the largest bandwidth that the noise explains (Lepski
// 1991).
#pragma once

#include <cstddef>
#include <vector>

#include "harness/recording/trajectory.h"

namespace touchstone::perception {

struct ReplayPath {
  MotionColumns motion;     // times and orientations as recorded
  std::size_t samples = 1;  // of the parabola; 1: the path as recorded
};
ReplayPath replay_path(const MotionColumns& recorded);

// Weights of a parabola over an odd number of even samples for its middle, first to last.
std::vector<double> parabola_weights(std::size_t samples);

// Standard deviation of white noise in a column by fourth differences, in which no movement of a hand is left: each
// sample enters with 1, -4, 6, -4, 1, variance 70. At least 5 samples.
double white_noise_of(const std::vector<double>& x);

}  // namespace touchstone::perception
