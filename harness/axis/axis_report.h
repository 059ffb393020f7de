// What was found about an axis, for people and programs.
#pragma once

#include <optional>
#include <string>

#include "harness/axis/axis_fit.h"
#include "harness/base/rooms.h"

namespace touchstone::axis {

// The words of a joint ("torque over angle") or of an indentation ("force over indentation").
struct AxisWords {
  std::string place = "angle", place_unit = "rad", load = "torque", load_unit = "N m";
  bool indentation = false;
};

// The unit of a term, from those of place and load.
std::string unit_of_term(AxisTermKind term, const AxisWords& words);

// `floor`: what a repeat of the recording differs by, if there is one.
std::string axis_text(const AxisFit& fit, const AxisWords& words, std::optional<double> floor);
// The same without what axis_remarks() says.
std::string axis_values(const AxisFit& fit, const AxisWords& words);
// Schema "touchstone-axis/1".
std::string axis_json(const AxisFit& fit, const AxisWords& words, std::optional<double> floor);
// What the motion cannot tell and which motion would, a sentence each; empty where all is told.
std::vector<std::string> axis_remarks(const AxisFit& fit, const AxisWords& words, std::optional<double> floor);

}  // namespace touchstone::axis
