// Two files that should show the same and do not: is one of them the other with a fault? Force reversed, positions in
// another unit, force in another frame, its axes mirrored or exchanged, clock shifted: each is tried on `obtained`, and
// named with what it gains. A repair must leave less than half of the difference.
#pragma once

#include <vector>

#include "harness/recording_checks/check_recording.h"

namespace touchstone::recording_checks {

// Both need time, position and force. Empty where no repair explains the difference, or where there is none.
std::vector<RecordingFinding> find_pair_faults(const recording::Recording& expected,
                                               const recording::Recording& obtained);

}  // namespace touchstone::recording_checks
