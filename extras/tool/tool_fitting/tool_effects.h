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
#include "harness/tool/coupling.h"

namespace touchstone::tool_fitting {

// Largest loads of a recording, from which an effect takes the width of what an instrument could have.
struct ToolRecordingScales {
  double force_N = 0.0;
  double torque_Nm = 0.0;
};

inline constexpr int most_of_an_effect = 4;  // parameters

struct ToolEffectTraits {
  std::string name;    // "lever-arm"
  std::string what;    // one line
  std::string unit;    // of the values that are reported
  std::string source;  // where the law is from
  int count = 3;       // parameters: along x, y and z of the tool; one; or as `what` says
  // Width of the prior of parameter k: what an instrument could have.
  double (*plausible)(const ToolRecordingScales& scales, int k) = nullptr;
  // One of the following two kinds.
  // Added to what is shown, in proportion to its parameters, a column each: force in the first three rows, torque
  // below. `gravity_T` is the acceleration of gravity in the tool's axes, m/s^2.
  using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, most_of_an_effect>;
  Columns (*columns)(const Wrench& w_T, const Vec3& gravity_T) = nullptr;
  // Such a one that is there whatever is measured: a bias, a weight.
  bool of_every_sensor = false;
  // Between handle and contact: changes the coupling by its one parameter v, nought as declared; and the value of the
  // coupling that is reported, whose standard error is that value times that of v.
  void (*change)(double v, tool::Coupling& coupling) = nullptr;
  double (*value)(const tool::Coupling& coupling) = nullptr;
};

// Those that change what is shown first.
const std::vector<ToolEffectTraits>& tool_effects();

// Standard gravity along -z of the object's frame, in the tool's axes.
Vec3 gravity_in_tool(const Quat& q_WT);

}  // namespace touchstone::tool_fitting
