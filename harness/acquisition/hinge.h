// The instant at which a moving tip is stopped by a surface: h(t) = level + s max(0, t0 - t) by least squares over
// (level, s, t0).
#pragma once

#include <vector>

#include "harness/acquisition/tap_alignment.h"
#include "harness/base/rooms.h"

namespace touchstone::acquisition {

// Fits within two samples of `stop_guess_s`, from the straight part of the approach (at most `approach_s` long) to
// `level_until_s`, where the tip still rests on the surface. With too few samples the guess comes back, one sample
// uncertain.
MotionStop fit_hinge(const std::vector<double>& t_s, const std::vector<double>& height_m, double stop_guess_s,
                     double level_until_s, double approach_s);

}  // namespace touchstone::acquisition
