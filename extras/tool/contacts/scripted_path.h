// A way of the handle through all poses of an exact case, as a hand would go: from one to the next with the least jerk,
// with a slow circle and a tremor on top.
#pragma once

#include "contacts/exact_cases.h"

namespace touchstone::contacts {

// At time t of a path that takes `duration_s`; it starts and ends at the case's free pose. Least jerk: Flash and Hogan
// 1985. Tremor: 0.05 mm and 2 mrad at 9 Hz (physiological tremor of the hand is at 8 to 12 Hz).
tool::Pose scripted_pose(const ExactCase& exact_case, double t_s, double duration_s);

}  // namespace touchstone::contacts
