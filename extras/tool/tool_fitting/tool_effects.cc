#include "tool_fitting/tool_effects.h"

#include <cmath>

namespace touchstone::tool_fitting {
namespace {

using Columns = ToolEffectTraits::Columns;

constexpr double standard_gravity_m_per_s2 = 9.80665;
constexpr double hand_m = 0.1;  // the size of a hand: no lever of a tool that one holds is off by more

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

ToolEffectTraits force_bias() {
  ToolEffectTraits effect;
  effect.name = "force-bias";
  effect.of_every_sensor = true;
  effect.what = "force that the sensor shows at no load";
  effect.unit = "N";
  effect.source = "additive offset of each channel";
  effect.plausible = [](const ToolRecordingScales& scales, int /*k*/) { return scales.force_N; };
  effect.columns = [](const Wrench& /*w_T*/, const Vec3& /*gravity_T*/) {
    Columns columns = Columns::Zero(6, 3);
    columns.topRows<3>().setIdentity();
    return columns;
  };
  return effect;
}

ToolEffectTraits torque_bias() {
  ToolEffectTraits effect;
  effect.name = "torque-bias";
  effect.of_every_sensor = true;
  effect.what = "torque that the sensor shows at no load";
  effect.unit = "Nm";
  effect.source = "additive offset of each channel";
  effect.plausible = [](const ToolRecordingScales& scales, int /*k*/) { return scales.torque_Nm; };
  effect.columns = [](const Wrench& /*w_T*/, const Vec3& /*gravity_T*/) {
    Columns columns = Columns::Zero(6, 3);
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
  effect.plausible = [](const ToolRecordingScales& /*scales*/, int /*k*/) { return hand_m; };
  effect.columns = [](const Wrench& w_T, const Vec3& /*gravity_T*/) {
    Columns columns = Columns::Zero(6, 3);
    columns.bottomRows<3>() = cross_matrix(w_T.f_N);
    return columns;
  };
  return effect;
}

// What the sensor carries beyond itself pulls down, and turns about the handle: f + m g and tau + (m c) x g.
ToolEffectTraits tool_weight() {
  ToolEffectTraits effect;
  effect.name = "tool-weight";
  effect.of_every_sensor = true;
  effect.what = "mass of the tool beyond the sensor, and that mass times the way from the handle to its centre";
  effect.unit = "kg, kg m";
  effect.source = "statics of a rigid body: weight at the centre of mass";
  effect.count = 4;
  effect.plausible = [](const ToolRecordingScales& scales, int k) {
    return scales.force_N / standard_gravity_m_per_s2 * (k == 0 ? 1.0 : hand_m);
  };
  effect.columns = [](const Wrench& /*w_T*/, const Vec3& gravity_T) {
    Columns columns = Columns::Zero(6, 4);
    columns.topLeftCorner<3, 1>() = gravity_T;
    columns.bottomRightCorner<3, 3>() = -cross_matrix(gravity_T);
    return columns;
  };
  return effect;
}

// A tool that gives way is a spring in series with the declared coupling: 1 / k = 1 / k_declared + compliance. Searched
// as a logarithm: a stiffness that is off by more than a factor e was not declared for this tool.
constexpr double plausible_logarithm(const ToolRecordingScales& /*scales*/, int /*k*/) { return 1.0; }

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
  static const std::vector<ToolEffectTraits> all{force_bias(),  torque_bias(), lever_arm(),
                                                 tool_weight(), stiffness(),   rotational_stiffness()};
  return all;
}

Vec3 gravity_in_tool(const Quat& q_WT) { return q_WT.conjugate() * Vec3(0.0, 0.0, -standard_gravity_m_per_s2); }

}  // namespace touchstone::tool_fitting
