// Where to start looking for a surface texture: the normal residual as a height (residual over stiffness) against waves
// over the object's xy plane, by least-squares periodogram (Lomb 1976; Scargle 1982) on a grid of wave vectors.
#pragma once

#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

struct TexturePeak {
  double amplitude_m;
  double wavelength_m;
  double direction_rad;
  double phase_rad;
  double power;  // share of the residual's variance that the wave explains
};

// The strongest `count` peaks, none beside another. Waves from 2 extents down to where the scan no longer resolves
// them.
std::vector<TexturePeak> texture_peaks(const recording::Recording& recording, const rendering::Prediction& current,
                                       double extent_m, std::size_t count);

}  // namespace touchstone::discrepancy
