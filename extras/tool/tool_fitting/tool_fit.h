// What the instrument adds to a recording of force and torque with a tool, found beside a renderer of tools.
//
// A sensor between the hand and the tool does not measure what pose.h calls the wrench at the handle, but, in the
// sensor's axes (those of the tool, T),
//   f_measured   = R^T f + b_f
//   tau_measured = R^T tau - r x (R^T f) + b_tau
// where f and tau are the object's on the tool about the handle in W, R turns T into W, r is the lever arm from the
// declared handle to the point that the torque is really about (wrench_about in harness/base/wrench.h), and b_f and
// b_tau are what the sensor shows at no load. Between the handle and the contact the tool and its mount give way like
// springs in series with the declared coupling, so that the stiffnesses that fit are
//   1 / k_fit = 1 / k_declared + compliance.
// What the sensor carries beyond itself, of mass m with its centre at c in T, adds m g and (m c) x g, g gravity in T.
// The stiffnesses enter through the renderer (Gauss and Newton's method on their logarithms, with forward differences);
// the rest is linear in every step.
//
// Which of these effects the recording needs is found by nested comparisons on blocks of time that were not fitted
// (tool_search.h); errors before and after are of blocks that neither the fit nor that choice has seen. Intervals are
// by the sandwich over the fitted blocks (harness/stats/sandwich.h), never narrower than those of independent samples.
// Each value has a weak prior of the width of what an instrument could have; a value whose standard error stays near
// that width is reported as undetermined: the motion does not show it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/tool/coupling.h"
#include "tool_fitting/tool_fitter.h"
#include "tool_fitting/tool_search.h"

namespace touchstone::tool_fitting {

struct ToolEffect {
  std::string name;  // as tool_effects() has it: force-bias, lever-arm, ...
  std::string what;
  std::string unit;
  std::vector<double> values;           // x, y, z in the tool's axes, or one; of what is not named: as if it were
  std::vector<double> standard_errors;  // of each
  std::vector<bool> determined;         // whether the motion tells it
  double p = 1.0;                       // of its being nought (stiffness: the declared one)
  // On blocks that were not fitted, with it over without it.
  ToolGain gain;
  bool named = false;
  std::vector<std::string> rivals;  // that explain the recording about as well in its place
};

// As findings of points have it (harness/discrepancy/findings.h).
enum class ToolVerdict : std::uint8_t {
  consistent,        // nothing of the instrument stands out, and nothing more is there
  explained,         // by the effects that are named
  unexplained,       // something is there that no known effect explains, or the recording is misread
  not_identifiable,  // this motion cannot tell an effect that is named from a rival
};
std::string to_string(ToolVerdict verdict);

struct ToolFit {
  ToolVerdict verdict = ToolVerdict::consistent;
  std::vector<ToolEffect> effects;
  tool::Coupling declared;
  tool::Coupling coupling;  // that fits; the declared one where the effect is not named
  ToolErrors before;        // the renderer as declared
  ToolErrors after;         // with the effects that are named
  ToolErrors noise;         // of the recording from sample to sample, of all three axes together
  std::optional<ToolMisreading> misreading;
  std::vector<std::string> remarks;
  // What the declared renderer and what the fitted one with the named effects say that the sensor measures, a sample
  // each, about the handle in W.
  std::vector<Wrench> declared_W, fitted_W;
};

// `measured`: the handle's poses, and force and torque as the sensor gives them, turned into W. Throws BadData without
// orientation or torque, with fewer than 400 samples, or without contact; RendererFailed when the renderer breaks down.
ToolFit fit_tool(const recording::Recording& measured, const MakeTool& make, const tool::Coupling& declared);

// What was found, in sentences: one line each.
std::string tool_fit_text(const ToolFit& fit);
std::string tool_fit_json(const ToolFit& fit);

}  // namespace touchstone::tool_fitting
