// What was found about an axis, for people and programs.
#pragma once

#include <optional>
#include <string>

#include "axis_fit.h"

namespace touchstone::axis {

// The words of a joint ("torque over angle") or of an indentation ("force over indentation").
struct AxisWords {
  std::string place = "angle", place_unit = "rad", load = "torque", load_unit = "N m";
  bool indentation = false;
};

// The unit of a term, from those of place and load.
std::string unit_of_term(AxisTermKind term, const AxisWords& words);

// What one recording does not repeat, in the unit of the load, and how large an error is as large by chance.
struct AxisFloor {
  double value = 0.0;
  double within = 0.0;
};
// `floor`: of a repeat of the recording, if there is one.
std::string axis_text(const AxisFit& fit, const AxisWords& words, const std::optional<AxisFloor>& floor);
// The same without what axis_remarks() says.
std::string axis_values(const AxisFit& fit, const AxisWords& words);
// Schema "touchstone-axis/1".
std::string axis_json(const AxisFit& fit, const AxisWords& words, const std::optional<AxisFloor>& floor);
// What the motion cannot tell and which motion would, a sentence each; empty where all is told.
std::vector<std::string> axis_remarks(const AxisFit& fit, const AxisWords& words,
                                      const std::optional<AxisFloor>& floor);

}  // namespace touchstone::axis
