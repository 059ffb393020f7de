// The fit of one axis (harness/axis) from files to a report.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "axis_fit.h"
#include "axis_input.h"
#include "harness/report/provenance.h"

namespace touchstone::axis {

struct AxisRequest {
  std::string recording, repeat;  // repeat: the same motion recorded again; empty: none
  bool flip_force = false;        // both files have the reversed load
};

struct AxisResult {
  AxisInput input;
  AxisFit fit;
  std::optional<AxisFloor> floor;

  [[nodiscard]] std::string text() const;  // for people
  [[nodiscard]] std::string json() const;  // schema "touchstone-axis/1"
};

// What is worth knowing of the recording, a sentence each. Throws BadData if it is faulty (check_recording.h).
std::vector<std::string> check_axis(const AxisInput& input);

// Fits. Throws BadData for a bad file, for a repeat that cannot be compared, and for a load that drives the motion
// (reversed).
AxisResult run_axis(const AxisRequest& request, AxisInput input);

// DIR/axis.json and DIR/report.html; returns the page's path. Throws BadData if the folder cannot be written.
std::filesystem::path write_axis(const AxisRequest& request, const AxisResult& result,
                                 const std::vector<std::string>& command_line, const std::filesystem::path& folder);

}  // namespace touchstone::axis
