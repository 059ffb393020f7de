// The faults of a recording that are looked for (check_recording.h, column_faults.h, pair_faults.h).
#pragma once

#include <string_view>

namespace touchstone::recording_checks {

enum class RecordingFault {
  reversed_force,      // the force by the probe in place of that on it
  mesh_unit_or_place,  // positions and object are far from each other
  force_frame,         // turned by the orientation, or not
  order,               // pieces of the log in another order than their time
  clock,               // force and position by clocks that differ
  registration,        // load is measured where there is no object
  no_contact,          // nothing is touched
  position_unit,       // positions a power of ten too large
  stuck_position,      // stands still to the last digit for a while
  stuck_force,
  constant_position,  // the same in every sample
  constant_force,     // of one axis
  saturated_force,    // at the end of the sensor's range
  repeated_samples,   // a buffer was written twice
};

// "reversed force", "mesh unit or place", ...
std::string_view to_string(RecordingFault fault);

}  // namespace touchstone::recording_checks
