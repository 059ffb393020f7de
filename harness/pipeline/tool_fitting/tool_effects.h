// What an instrument can add to a recording of force and torque with a tool. Each effect says of itself how it enters a
// fit, so that the fit holds no list of names (as harness/rendering/effect_traits.h does for points).
//
// Frames and signs: harness/tool/pose.h. The wrench w = (f, tau) is the object's on the tool about the handle, in the
// tool's axes; what the sensor shows of it is in the tool's axes, too.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "harness/base/wrench.h"
#include "harness/pipeline/pipeline_rooms.h"
#include "harness/tool/coupling.h"

namespace touchstone::pipeline {

// Largest loads of a recording, from which an effect takes the width of what an instrument could have.
struct ToolRecordingScales {
  double force_N = 0.0;
  double torque_Nm = 0.0;
};

struct ToolEffectTraits {
  std::string name;    // "lever-arm"
  std::string what;    // one line
  std::string unit;    // of the values that are reported
  std::string source;  // where the law is from
  int count = 3;       // parameters: along x, y and z of the tool, or one
  // Width of the prior: what an instrument could have.
  double (*plausible)(const ToolRecordingScales& scales) = nullptr;
  // One of the following two kinds.
  // Added to what is shown, in proportion to its three parameters: force in the first three rows, torque below.
  using Columns = Eigen::Matrix<double, 6, 3>;
  Columns (*columns)(const Wrench& w_T) = nullptr;
  // Between handle and contact: changes the coupling by its one parameter v, nought as declared; and the value of the
  // coupling that is reported, whose standard error is that value times that of v.
  void (*change)(double v, tool::Coupling& coupling) = nullptr;
  double (*value)(const tool::Coupling& coupling) = nullptr;
};

// Those that change what is shown first.
const std::vector<ToolEffectTraits>& tool_effects();

}  // namespace touchstone::pipeline
