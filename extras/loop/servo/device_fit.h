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

#include "harness/recording/trajectory.h"

namespace touchstone::servo {

struct FittedFigure {
  double value = 0.0;
  double error95 = 0.0;  // half of the 95 % interval
  // The interval leaves zero out, or the value is zero and the interval small beside what would matter (see .cc).
  bool determined = false;
};

struct DeviceFit {
  FittedFigure mass_kg, damping_N_s_per_m, friction_N, latency_s;
  double period_s = 0.0;
  double residual_m = 0.0;  // root mean square of what the fit leaves of the positions
  double moved_m = 0.0;     // root mean square of the motion
  std::size_t samples = 0;
};

// Throws BadData for a recording without force or motion, with too few samples, or with an uneven period.
DeviceFit fit_device(const recording::Recording& recording);

}  // namespace touchstone::servo
