// Virtual walls of rising stiffness: what the device renders, how hard it feels at the first touch, and where it
// becomes unstable.
#pragma once

#include <functional>
#include <vector>

#include "lab/finding.h"
#include "lab/servo_loop.h"

namespace touchstone::hil {

struct WallSweep {
  double softest_N_per_m = 50.0;
  double stiffest_N_per_m = 6400.0;  // steps of sqrt(2) between
  std::vector<double> damping_N_s_per_m{0.0, 1.0, 2.0};
  double trial_s = 3.0;
  // Before each trial: the person lifts the handle off the wall (x > 0) and presses again.
  std::function<void()> prepare = [] {};
};

// The wall x = 0 with f = -K x - B v for x < 0, never pulling, cut at the force limit. A person grips the handle
// lightly and presses it against the wall. For each damping B the stiffness K rises until the contact oscillates or
// trips:
//   Z-width (Colgate and Brown 1994): the K below, for each B;
//   rate-hardness (Lawrence et al. 2000): largest rate of the rendered force in the first 10 ms of the touch over the
//     speed at the touch, for each K without damping;
//   stiffness rendered: mean commanded force over mean depth at rest (below the one asked for where the force limit
//     cuts).
// Commands forces: the bench needs a dead-man input. Throws DeviceError if the person stops it, or if the handle does
// not come to the wall.
Finding wall_sweep(Bench& bench, const LabLimits& limits, const WallSweep& sweep);

}  // namespace touchstone::hil
