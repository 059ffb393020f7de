// A measurement as the truth and everything that an instrument added to it, kept apart: measured = truth + sum of
// parts.
#pragma once

#include <vector>

#include "harness/base/vec.h"

namespace touchstone::datasets {

// A force sensor's samples in its own frame S.
struct ForceMeasurement {
  std::vector<double> t_s;
  std::vector<Vec3> truth_S_N;
  std::vector<Vec3> bias_S_N;      // constant and drift
  std::vector<Vec3> noise_S_N;     // coloured and white
  std::vector<Vec3> clipping_S_N;  // not 0 where the sensor saturated
  std::vector<Vec3> rounding_S_N;  // to the sensor's step
  std::vector<Vec3> measured_S_N;
};

// A tracker's samples in the object's frame W.
struct PoseMeasurement {
  std::vector<double> t_s;       // as stamped
  std::vector<Vec3> truth_W_m;   // at the instant of exposure
  std::vector<Vec3> noise_W_m;   // anew for every sample
  std::vector<Vec3> wander_W_m;  // slowly varying
  std::vector<Vec3> measured_W_m;
  std::vector<Quat> truth_WS;
  std::vector<Quat> measured_WS;
};

}  // namespace touchstone::datasets
