#include "tool_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/base/error.h"
#include "harness/perception/filters/weber_law.h"

namespace touchstone::tool {
using recording::Recording;

namespace {

void require_same_times(const MotionColumns& a, const MotionColumns& b, const std::string& name) {
  if (a.size() != b.size()) {
    throw BadData(
        fmt::format("{}: {} samples, {} were expected: both must come from one path", name, b.size(), a.size()));
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a.t_s[i] != b.t_s[i]) {
      throw BadData(fmt::format("{}: row {}: time {} s, {} s was expected: both must come from one path", name, i + 1,
                                b.t_s[i], a.t_s[i]));
    }
  }
}

void require_torque(const Recording& recording) {
  if (recording.torque_W_Nm.empty()) {
    throw BadData(fmt::format("{}: no torque: the columns tx_Nm, ty_Nm and tz_Nm were expected", recording.source));
  }
}

}  // namespace

double torque_error_in_jnd(const Vec3& expected_Nm, const Vec3& obtained_Nm) {
  return (obtained_Nm - expected_Nm).norm() /
         (torque_weber_fraction * std::max(expected_Nm.norm(), torque_reference_Nm));
}

double force_error_in_jnd(const Vec3& expected_N, const Vec3& obtained_N) {
  const double felt = perception::fingertip_force.just_noticeable_difference(expected_N.norm());
  return (obtained_N - expected_N).norm() / felt;
}

ToolComparison compare_tools(const Recording& expected, const Recording& obtained) {
  require_torque(expected);
  require_torque(obtained);
  require_same_times(expected.motion, obtained.motion, obtained.source);
  if (expected.size() == 0) throw BadData(fmt::format("{}: no samples to compare", expected.source));
  ToolComparison result;
  result.samples = expected.size();
  double worst = -1.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Vec3 force = obtained.f_W_N[i] - expected.f_W_N[i];
    const Vec3 torque = obtained.torque_W_Nm[i] - expected.torque_W_Nm[i];
    result.rms_force_error_N += force.squaredNorm();
    result.rms_torque_error_Nm += torque.squaredNorm();
    for (int k = 0; k < 3; ++k) {
      result.max_force_error_N[k] = worse(result.max_force_error_N[k], std::abs(force[k]));
      result.max_torque_error_Nm[k] = worse(result.max_torque_error_Nm[k], std::abs(torque[k]));
    }
    result.max_force_error_jnd =
        worse(result.max_force_error_jnd, force_error_in_jnd(expected.f_W_N[i], obtained.f_W_N[i]));
    result.max_torque_error_jnd =
        worse(result.max_torque_error_jnd, torque_error_in_jnd(expected.torque_W_Nm[i], obtained.torque_W_Nm[i]));
    if (!std::isnan(worst) && !(torque.norm() <= worst)) {
      worst = torque.norm();
      result.worst_torque_row = i;
    }
  }
  const auto n = static_cast<double>(result.samples);
  result.rms_force_error_N = std::sqrt(result.rms_force_error_N / n);
  result.rms_torque_error_Nm = std::sqrt(result.rms_torque_error_Nm / n);
  return result;
}

void compare_proxies(const recording::InTrajectory& expected, const recording::InTrajectory& obtained,
                     const Recording& wrenches, const Coupling& coupling, ToolComparison& comparison) {
  require_same_times(expected.motion, obtained.motion, "the obtained proxy");
  require_same_times(wrenches.motion, expected.motion, "the expected proxy");
  if (expected.motion.q_WS.empty() || obtained.motion.q_WS.empty()) {
    throw BadData("a file of the proxy has no orientation: the columns qw, qx, qy and qz were expected");
  }
  double translation = 0.0, translation_jnd = 0.0;
  double rotation = 0.0, rotation_jnd = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Displacement apart = displacement({expected.motion.p_W_m[i], expected.motion.q_WS[i]},
                                            {obtained.motion.p_W_m[i], obtained.motion.q_WS[i]});
    translation = worse(translation, apart.translation_m.norm());
    rotation = worse(rotation, apart.rotation_rad.norm());
    const Vec3& force = wrenches.f_W_N[i];
    const Vec3& torque = wrenches.torque_W_Nm[i];
    const Vec3 more_force = force + coupling.stiffness_N_per_m * apart.translation_m;
    const Vec3 more_torque = torque + coupling.rotational_stiffness_Nm_per_rad * apart.rotation_rad;
    translation_jnd = worse(translation_jnd, force_error_in_jnd(force, more_force));
    rotation_jnd = worse(rotation_jnd, torque_error_in_jnd(torque, more_torque));
  }
  comparison.max_proxy_translation_m = translation;
  comparison.max_proxy_rotation_rad = rotation;
  comparison.max_proxy_translation_jnd = translation_jnd;
  comparison.max_proxy_rotation_jnd = rotation_jnd;
}

std::string comparison_to_json(const ToolComparison& c) {
  const auto vector = [](const Vec3& v) { return nlohmann::ordered_json::array({v.x(), v.y(), v.z()}); };
  nlohmann::ordered_json json{{"samples", c.samples},
                              {"rms_force_error_N", c.rms_force_error_N},
                              {"rms_torque_error_Nm", c.rms_torque_error_Nm},
                              {"max_force_error_N", vector(c.max_force_error_N)},
                              {"max_torque_error_Nm", vector(c.max_torque_error_Nm)},
                              {"max_force_error_jnd", c.max_force_error_jnd},
                              {"max_torque_error_jnd", c.max_torque_error_jnd}};
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value) json[name] = *value;
  };
  add("max_proxy_translation_m", c.max_proxy_translation_m);
  add("max_proxy_rotation_rad", c.max_proxy_rotation_rad);
  add("max_proxy_translation_jnd", c.max_proxy_translation_jnd);
  add("max_proxy_rotation_jnd", c.max_proxy_rotation_jnd);
  return json.dump(2) + "\n";
}

std::string comparison_to_text(const ToolComparison& c) {
  std::string text =
      fmt::format("force error: rms {:.3g} N, largest ({:.3g}, {:.3g}, {:.3g}) N, {:.3g} JND\n", c.rms_force_error_N,
                  c.max_force_error_N.x(), c.max_force_error_N.y(), c.max_force_error_N.z(), c.max_force_error_jnd);
  text += fmt::format("torque error: rms {:.3g} mNm, largest ({:.3g}, {:.3g}, {:.3g}) mNm, {:.3g} JND, at row {}\n",
                      c.rms_torque_error_Nm * 1e3, c.max_torque_error_Nm.x() * 1e3, c.max_torque_error_Nm.y() * 1e3,
                      c.max_torque_error_Nm.z() * 1e3, c.max_torque_error_jnd, c.worst_torque_row + 1);
  if (c.max_proxy_translation_m) {
    text += fmt::format(
        "pose of the proxy: at most {:.3g} mm apart, {:.3g} JND of force; {:.3g} degrees, {:.3g} JND of torque\n",
        *c.max_proxy_translation_m * 1e3, *c.max_proxy_translation_jnd,
        *c.max_proxy_rotation_rad * 180.0 / std::numbers::pi, *c.max_proxy_rotation_jnd);
  }
  return text;
}

bool within(const ToolComparison& c, const Vec3& force_N, const Vec3& torque_Nm) {
  return (c.max_force_error_N.array() <= force_N.array()).all() &&
         (c.max_torque_error_Nm.array() <= torque_Nm.array()).all();
}

}  // namespace touchstone::tool
