// A device's mass, friction and latency from a recording of itself: nobody holds it, the servo commands forces (a
// virtual spring that is let go, a chirp), and position and commanded force are recorded once a period. Force is ON the
// device, as everywhere.
//
// Along the line of the largest motion the recording's forces drive the exact motion of axis_motion.h, and mass,
// viscous and Coulomb friction, latency and the beginning are those with which the positions fit best in least squares
// (Levenberg and Marquardt: More, Lecture Notes in Mathematics 630, 1978). Errors are from the curvature there; what
// the recording does not determine is said not to be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "harness/recording/trajectory.h"

namespace touchstone::servo {

struct FittedFigure {
  double value = 0.0;
  double error95 = 0.0;  // half of the 95 % interval
  // The 95 % interval ends below a hundredth of what would matter: the force, the force at the speed of the motion, a
  // period.
  bool negligible = false;
  bool determined = false;  // negligible, or the interval leaves zero out
};

// One effect's part of what became of the commanded force f(t): m a, b v, dry friction, and f(t) - f(t - latency),
// whose sum it is. The mean square of the part over the sum of all four's.
enum class Named : std::uint8_t { present, negligible, cannot_tell };
struct DeviceEffect {
  std::string_view name;
  Named named = Named::cannot_tell;
  double share = 0.0;
};

struct DeviceFit {
  FittedFigure mass_kg, damping_N_s_per_m, friction_N, latency_s;
  double resolution_m = 0.0;          // the step that all positions are multiples of; 0: none is seen
  std::vector<DeviceEffect> effects;  // inertia, viscous friction, dry friction, latency
  // Root mean square of what neither they nor the encoder's steps (resolution / sqrt 12) explain of the motion, over
  // that of the motion. Above a tenth something else moves the device, a hand, gravity or a spring, and no figure is
  // determined.
  double unexplained = 0.0;
  double period_s = 0.0;
  double residual_m = 0.0;  // root mean square of what the fit leaves of the positions
  double moved_m = 0.0;     // root mean square of the motion
  std::size_t samples = 0;
};

// Throws BadData for a recording without force or motion, with too few samples, or with an uneven period.
DeviceFit fit_device(const recording::Recording& recording);

}  // namespace touchstone::servo
