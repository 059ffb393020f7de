// What a person feels where nothing is touched: a steady force in free air (weight, drag, a pull), and a pull while the
// tip leaves the object (adhesion). Vibration in free air is in vibration.h.
#pragma once

#include <cstddef>

#include "harness/perception/judge/felt_series.h"
#include "harness/perception/judge/response.h"
#include "harness/perception/judge/thresholds.h"

namespace touchstone::perception {

struct FreeAir {
  // Root mean square of the mean force of 50 ms, without what the sensor's noise adds, and how far it would be another
  // from one window alone.
  double force_N = 0.0;
  double force_spread_N = 0.0;
  std::size_t windows = 0;
  // Largest mean of 20 ms against the outward direction within 0.1 s of leaving, mean over the releases.
  double pull_N = 0.0;
  double pull_error_N = 0.0;
  double leaving_m_per_s = 0.0;  // median over them
  std::size_t releases = 0;
};
FreeAir free_air(const FeltSeries& felt, const Response& response);

struct AirDifference {
  bool known = false;
  bool release = false;  // the pull on leaving, else the force in free air
  double jnd = 0.0;
  double standard_error = 0.0;
  double real_N = 0.0;
  double rendered_N = 0.0;
};
// In steps of force from nothing. A force in the air that both have goes with the hand (weight, inertia, drag): unless
// both moved alike, it is only known to a factor of two, and no better than one window tells it: another hand goes
// elsewhere. A pull may grow with the speed of leaving, or not (growth.h).
AirDifference air_difference(const FreeAir& real, const FreeAir& rendered, bool same_motion,
                             const Thresholds& thresholds);

}  // namespace touchstone::perception
