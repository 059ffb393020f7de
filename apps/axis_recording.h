// Recordings of one axis (a joint, an actuator, a spindle, an indentation along z) for the commands that take them:
// `axis`, and `fit` and `discrepancy`, which need neither model nor mesh for them.
#pragma once

#include <string>

#include "apps/apps_rooms.h"
#include "apps/command.h"

namespace touchstone::apps {

struct AxisRequest {
  std::string recording, repeat;
  std::string out, json;  // a folder for axis.json and report.html, and a file for axis.json; empty: none
  bool flip_force = false;
};

// Whether the file has a place and a load along one axis for columns: q_rad and torque_Nm, or q_m and force_N.
bool is_axis_recording(const std::string& path);

// Fits, prints, writes. Throws BadData for a bad file, a faulty recording, or a load that drives the motion.
ExitStatus run_axis(const AxisRequest& request);

}  // namespace touchstone::apps
