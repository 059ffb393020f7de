// The motion without the tracker's noise, as far as the recording tells them apart.
//
// Laws that differentiate the motion (viscosity) or follow its path (friction) pass tracker noise on in very different
// measure. Two laws that a recording cannot tell apart may then differ only in how noisy they are at noisy positions:
// whether they are alike is judged on the smoothed motion too.
#pragma once

#include "harness/discrepancy/instrument_description.h"

namespace touchstone {

// Local quadratic regression in time with tricube weights (Cleveland 1979, section 2), of the longest window that takes
// away no more than the declared noise explains (discrepancy principle, Morozov 1966). Unchanged without position
// noise.
MotionColumns smoothed_motion(const MotionColumns& motion, const InstrumentDescription& instrument);

}  // namespace touchstone
