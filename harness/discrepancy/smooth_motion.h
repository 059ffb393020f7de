// The motion without the tracker's noise, as far as the recording tells them apart.
//
// A hand moves more slowly than a tracker's noise, so that the noise of one sample shows against its neighbours. Where
// the true tip went is therefore better known than the tracker's noise says, and a model at the recorded positions is
// off in a way that can be foreseen. Laws that differentiate the motion (viscosity) or follow its path (friction) pass
// tracker noise on in very different measure: whether two of them are indistinguishable is also judged on it.
#pragma once

#include <vector>

#include "harness/discrepancy/instrument_description.h"

namespace touchstone::discrepancy {

// Local quadratic regression in time with tricube weights (Cleveland 1979, section 2). At every sample the window is
// the longest whose estimate agrees, within the noise, with those of all shorter windows (intersection of confidence
// intervals: Goldenshluger and Nemirovski 1997; Katkovnik 1999), so that a quick press keeps its peak while a slow hold
// is averaged over long. Linear in the positions once the windows are chosen.
class MotionSmoother {
 public:
  // Without position noise nothing is smoothed.
  MotionSmoother(const MotionColumns& motion, const InstrumentDescription& instrument);

  [[nodiscard]] MotionColumns smoothed(const MotionColumns& motion) const;
  // What smoothing leaves of one draw of tracker noise: how far the smoothed motion may be from the true one.
  [[nodiscard]] std::vector<Vec3> left_of_noise(Random& random) const;

 private:
  InstrumentDescription instrument_;
  std::vector<double> t_s_;
  std::vector<double> half_window_s_;  // of every sample; empty: nothing is smoothed
};

MotionColumns smoothed_motion(const MotionColumns& motion, const InstrumentDescription& instrument);

}  // namespace touchstone::discrepancy
