// What a person feels where nothing is touched: a steady force in free air (weight, a pull), drag and inertia of the
// tool, and a pull while the tip leaves the object (adhesion). Vibration in free air is in vibration.h.
#pragma once

#include <cstddef>

#include "harness/perception/judge/felt_series.h"
#include "harness/perception/judge/response.h"
#include "harness/perception/judge/thresholds.h"

namespace touchstone::perception {

// The tool as free air shows it: force = steady - drag * velocity - mass * acceleration, in all directions alike, by
// least squares.
struct ToolInAir {
  bool seen = false;  // drag and mass explain most of how the force in free air varies
  double drag_N_s_per_m = 0.0;
  double mass_kg = 0.0;
  // Standard errors by leaving out one of jackknife_blocks stretches after the other.
  double drag_error = 0.0;
  double mass_error = 0.0;
  // Root mean squares in free air.
  double speed_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
};
// Takes what the tool adds out of the whole force, if it is seen: in contact it is no force of the object.
ToolInAir take_out_tool(FeltSeries& felt, const FirstContact& contact);

struct FreeAir {
  ToolInAir tool;
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

enum class AirCue : unsigned char { steady, release, drag, mass };
struct AirDifference {
  bool known = false;
  AirCue cue = AirCue::steady;
  double jnd = 0.0;
  double standard_error = 0.0;
  double real = 0.0;  // N, N s/m or kg
  double rendered = 0.0;
};
// In steps of force from nothing. Drag and mass are compared by the force that they make at the motion of the hand that
// moved less, as damping in contact is. A force in the air that both have goes with the hand (weight): unless
// both moved alike, it is only known to a factor of two, and no better than one window tells it: another hand goes
// elsewhere. A pull may grow with the speed of leaving, or not (growth.h).
AirDifference air_difference(const FreeAir& real, const FreeAir& rendered, bool same_motion,
                             const Thresholds& thresholds);

}  // namespace touchstone::perception
