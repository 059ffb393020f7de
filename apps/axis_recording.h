// A recording of one axis, which has no object and no model, in the place of one of a contact: `fit` and `discrepancy`
// leave it to the extra `touchstone axis`.
#pragma once

#include <string>
#include <vector>

#include "harness/base/error.h"

namespace touchstone::apps {

// Whether the file has a place and a load along one axis for columns: q_rad and torque_Nm, or q_m and force_N. A file
// that cannot be read has none.
bool is_axis_recording(const std::string& path);

struct AxisRecording {
  std::string recording, repeat;  // empty: none
  bool flip_force = false;
  std::string out, json;             // as `touchstone axis` takes them; empty: none
  std::vector<std::string> useless;  // options that were given and that such a recording has no use for
};

// Runs `touchstone axis` on it; its exit status. Throws UsageError for a useless option, and where there is no such
// program.
ExitStatus run_axis(const AxisRecording& options);

}  // namespace touchstone::apps
