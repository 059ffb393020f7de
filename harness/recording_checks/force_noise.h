// The noise of a recorded force, from the samples alone.
#pragma once

#include <span>

#include "harness/base/vec.h"

namespace touchstone::recording_checks {

// Standard deviation of white noise on the noisiest axis [N]: the median absolute fourth difference of consecutive
// samples over what white noise of 1 N makes (0.6745 sqrt(70)). A motion at a tenth of the sampling rate adds 0.15 of
// its own amplitude to a fourth difference, a slower one less, and the median passes over taps and steps. 0 for fewer
// than 16 samples and for forces that were rounded to their noise.
double force_noise_N(std::span<const Vec3> forces);

}  // namespace touchstone::recording_checks
