// A recording of one axis (a joint, an actuator, a spindle, an indentation along z) from a file.
// Place and load have the file's signs: a load that pushes towards a larger place is positive. A recording that presses
// along z becomes an indentation, which grows downwards, and the force that pushes up against it.
#pragma once

#include <string>

#include "axis_fit.h"
#include "axis_report.h"
#include "harness/recording/trajectory.h"

namespace touchstone::axis {

struct AxisInput {
  AxisRun run;
  AxisWords words;  // what its columns are: angle and torque, place and force, indentation and force
};

// Reads t_s with q_rad and torque_Nm (and qd_rad_per_s), with q_m and force_N (and qd_m_per_s), or a recording that
// presses along z. `flip_force` negates the load. Throws BadData for a file without such columns, and as the readers
// do.
AxisInput load_axis(const std::string& path, bool flip_force);

// Place and load along x, for what looks at recordings. A place in rad stands for one in m.
recording::Recording as_recording(const AxisRun& run);

}  // namespace touchstone::axis
