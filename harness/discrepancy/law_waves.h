// Where waves may be in what a model leaves: the strongest peaks of the residual's spectrum over time and over place
// (least-squares periodogram of unevenly spaced samples: Lomb 1976; over place with a wave vector in the place of a
// frequency).
#pragma once

#include <vector>

#include "harness/base/vec.h"
#include "harness/discrepancy/law_library.h"

namespace touchstone::discrepancy {

// Means over blocks: time, place and residual there [N].
struct LeftOver {
  std::vector<double> t_s;
  std::vector<Vec3> p_W_m;
  std::vector<Vec3> f_W_N;
};

// At most three of each; none where there are fewer than 30 blocks.
WavePeaks wave_peaks(const LeftOver& left);

}  // namespace touchstone::discrepancy
