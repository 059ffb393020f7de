// Where to start looking for a place where the object is stiffer, softer, higher or lower than the model: a Gaussian
// bump on a grid of places and widths, each regressed on the residual along the normal (linear least squares, with the
// general stiffness and an offset along the normal as nuisances), the strongest kept.
#pragma once

#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

enum class BumpOf { stiffness, surface };

struct BumpPeak {
  double amplitude = 0.0;  // share of the stiffness, or height of the surface in m
  double x_m = 0.0;
  double y_m = 0.0;
  double width_m = 0.0;
  double power = 0.0;  // share of the residual's square that the bump explains
};

// At most `count` bumps over the box of positions in contact, strongest first, none within another.
std::vector<BumpPeak> bump_peaks(const recording::Recording& recording, const rendering::Prediction& current, BumpOf of,
                                 const Vec3& low_W_m, const Vec3& high_W_m, std::size_t count);

}  // namespace touchstone::discrepancy
