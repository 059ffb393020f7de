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
// The stiffnesses enter through the renderer (Gauss and Newton's method on their logarithms, with forward differences);
// the rest is linear in every step.
//
// The time is cut into blocks, which are given in turn to the fit and to the judgement: errors before and after are of
// blocks that the fit has not seen. Intervals are by the sandwich over the blocks (harness/stats/sandwich.h), never
// narrower than those of independent samples. An effect is named if a Wald test by an F distribution over the blocks
// (Hotelling 1931) rejects that it is nought at 5 %, divided among the effects (Bonferroni). Each value has a weak
// prior of the width of what an instrument could have; a value whose standard error stays near that width is called
// undetermined: the motion does not tell it.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/pipeline/pipeline_rooms.h"
#include "harness/recording/trajectory.h"
#include "harness/tool/coupling.h"
#include "harness/tool/tool_renderer.h"

namespace touchstone::pipeline {

// A renderer with this coupling, from its beginning.
using MakeTool = std::function<std::unique_ptr<tool::ToolRenderer>(const tool::Coupling&)>;

struct ToolEffect {
  std::string name;  // force-bias, torque-bias, lever-arm, stiffness, rotational-stiffness
  std::string what;
  std::string unit;
  std::vector<double> values;           // x, y, z in the tool's axes, or one
  std::vector<double> standard_errors;  // of each
  std::vector<bool> determined;         // whether the motion tells it
  double p = 1.0;                       // of its being nought (stiffness: the declared one)
  bool named = false;
};

// Root mean squares over the blocks that the fit has not seen, of all three axes together.
struct ToolErrors {
  double force_N = 0.0;
  double torque_Nm = 0.0;
};

struct ToolFit {
  std::vector<ToolEffect> effects;
  tool::Coupling declared;
  tool::Coupling coupling;  // that fits; the declared one where the effect is not named
  ToolErrors before;        // the renderer as declared
  ToolErrors after;         // with the effects that are named
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

}  // namespace touchstone::pipeline
