// What can be learnt of a device without a force: friction when it is moved by hand, and how evenly its servo loop
// runs.
#pragma once

#include "lab/finding.h"
#include "lab/servo_loop.h"

namespace touchstone::hil {

// A person moves the handle slowly to and fro along the device's x with a force sensor between hand and handle (its x
// along the device's). Least squares of F = f_c sign(v) + b v + m a + c over what moves faster than `slowest_m_per_s`:
// Coulomb friction, viscous friction and felt mass (Armstrong-Helouvry et al. 1994, section 2, without Stribeck's
// part). Throws DeviceError where the handle hardly moved.
Finding friction_by_hand(Bench& bench, const LabLimits& limits, double seconds, double slowest_m_per_s = 0.01);

// Periods of the loop at zero force. `hold_limits`: where the run was scheduled for it (a real-time policy), or where
// the clock is simulated; elsewhere the lateness is reported and only counting is checked.
Finding servo_regularity(Bench& bench, const LabLimits& limits, double seconds, bool hold_limits);

}  // namespace touchstone::hil
