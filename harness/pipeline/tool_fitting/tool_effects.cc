#include "harness/pipeline/tool_fitting/tool_effects.h"

#include <cmath>

namespace touchstone::pipeline {
namespace {

using Columns = ToolEffectTraits::Columns;

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

ToolEffectTraits force_bias() {
  ToolEffectTraits effect;
  effect.name = "force-bias";
  effect.what = "force that the sensor shows at no load";
  effect.unit = "N";
  effect.source = "additive offset of each channel";
  effect.plausible = [](const ToolRecordingScales& scales) { return scales.force_N; };
  effect.columns = [](const Wrench& /*w_T*/) {
    Columns columns = Columns::Zero();
    columns.topRows<3>().setIdentity();
    return columns;
  };
  return effect;
}

ToolEffectTraits torque_bias() {
  ToolEffectTraits effect;
  effect.name = "torque-bias";
  effect.what = "torque that the sensor shows at no load";
  effect.unit = "Nm";
  effect.source = "additive offset of each channel";
  effect.plausible = [](const ToolRecordingScales& scales) { return scales.torque_Nm; };
  effect.columns = [](const Wrench& /*w_T*/) {
    Columns columns = Columns::Zero();
    columns.bottomRows<3>().setIdentity();
    return columns;
  };
  return effect;
}

// The torque about the handle plus r is tau - r x f = tau + f x r.
ToolEffectTraits lever_arm() {
  ToolEffectTraits effect;
  effect.name = "lever-arm";
  effect.what = "way from the declared handle to the point that the torque is about";
  effect.unit = "m";
  effect.source = "Murray, Li and Sastry 1994, section 2.5: the wrench about another point";
  // The size of a hand.
  effect.plausible = [](const ToolRecordingScales& /*scales*/) { return 0.1; };
  effect.columns = [](const Wrench& w_T) {
    Columns columns = Columns::Zero();
    columns.bottomRows<3>() = cross_matrix(w_T.f_N);
    return columns;
  };
  return effect;
}

// A tool that gives way is a spring in series with the declared coupling: 1 / k = 1 / k_declared + compliance. Searched
// as a logarithm: a stiffness that is off by more than a factor e was not declared for this tool.
constexpr double plausible_logarithm(const ToolRecordingScales& /*scales*/) { return 1.0; }

ToolEffectTraits stiffness() {
  ToolEffectTraits effect;
  effect.name = "stiffness";
  effect.what = "stiffness between handle and contact: how far the tool gives way";
  effect.unit = "N/m";
  effect.source = "springs in series: the tool's compliance beside the coupling's";
  effect.count = 1;
  effect.plausible = plausible_logarithm;
  effect.change = [](double v, tool::Coupling& coupling) { coupling.stiffness_N_per_m *= std::exp(v); };
  effect.value = [](const tool::Coupling& coupling) { return coupling.stiffness_N_per_m; };
  return effect;
}

ToolEffectTraits rotational_stiffness() {
  ToolEffectTraits effect;
  effect.name = "rotational-stiffness";
  effect.what = "rotational stiffness between handle and contact: how far the tool turns under a torque";
  effect.unit = "Nm/rad";
  effect.source = "springs in series: the tool's compliance beside the coupling's";
  effect.count = 1;
  effect.plausible = plausible_logarithm;
  effect.change = [](double v, tool::Coupling& coupling) { coupling.rotational_stiffness_Nm_per_rad *= std::exp(v); };
  effect.value = [](const tool::Coupling& coupling) { return coupling.rotational_stiffness_Nm_per_rad; };
  return effect;
}

}  // namespace

const std::vector<ToolEffectTraits>& tool_effects() {
  static const std::vector<ToolEffectTraits> all{force_bias(), torque_bias(), lever_arm(), stiffness(),
                                                 rotational_stiffness()};
  return all;
}

}  // namespace touchstone::pipeline
