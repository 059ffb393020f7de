#include "harness/tool/tool_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/base/error.h"

namespace touchstone::tool {
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
         (kTorqueWeberFraction * std::max(expected_Nm.norm(), kTorqueReference_Nm));
}

ToolComparison compare_tools(const Recording& expected, const Recording& obtained) {
  require_torque(expected);
  require_torque(obtained);
  require_same_times(expected.motion, obtained.motion, obtained.source);
  ToolComparison result;
  result.samples = expected.size();
  double worst = -1.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Vec3 force = obtained.f_W_N[i] - expected.f_W_N[i];
    const Vec3 torque = obtained.torque_W_Nm[i] - expected.torque_W_Nm[i];
    result.rms_force_error_N += force.squaredNorm();
    result.rms_torque_error_Nm += torque.squaredNorm();
    result.max_force_error_N = result.max_force_error_N.cwiseMax(force.cwiseAbs());
    result.max_torque_error_Nm = result.max_torque_error_Nm.cwiseMax(torque.cwiseAbs());
    result.max_torque_error_jnd =
        std::max(result.max_torque_error_jnd, torque_error_in_jnd(expected.torque_W_Nm[i], obtained.torque_W_Nm[i]));
    if (torque.norm() > worst) {
      worst = torque.norm();
      result.worst_torque_row = i;
    }
  }
  const auto n = static_cast<double>(result.samples);
  result.rms_force_error_N = std::sqrt(result.rms_force_error_N / n);
  result.rms_torque_error_Nm = std::sqrt(result.rms_torque_error_Nm / n);
  return result;
}

void compare_proxies(const InTrajectory& expected, const InTrajectory& obtained, ToolComparison& comparison) {
  require_same_times(expected.motion, obtained.motion, "the obtained proxy");
  if (expected.motion.q_WS.empty() || obtained.motion.q_WS.empty()) {
    throw BadData("a file of the proxy has no orientation: the columns qw, qx, qy and qz were expected");
  }
  double translation = 0.0;
  double rotation = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Displacement apart = displacement({expected.motion.p_W_m[i], expected.motion.q_WS[i]},
                                            {obtained.motion.p_W_m[i], obtained.motion.q_WS[i]});
    translation = std::max(translation, apart.translation_m.norm());
    rotation = std::max(rotation, apart.rotation_rad.norm());
  }
  comparison.max_proxy_translation_m = translation;
  comparison.max_proxy_rotation_rad = rotation;
}

std::string comparison_to_json(const ToolComparison& c) {
  const auto vector = [](const Vec3& v) { return nlohmann::ordered_json::array({v.x(), v.y(), v.z()}); };
  nlohmann::ordered_json json{{"samples", c.samples},
                              {"rms_force_error_N", c.rms_force_error_N},
                              {"rms_torque_error_Nm", c.rms_torque_error_Nm},
                              {"max_force_error_N", vector(c.max_force_error_N)},
                              {"max_torque_error_Nm", vector(c.max_torque_error_Nm)},
                              {"max_torque_error_jnd", c.max_torque_error_jnd}};
  if (c.max_proxy_translation_m) json["max_proxy_translation_m"] = *c.max_proxy_translation_m;
  if (c.max_proxy_rotation_rad) json["max_proxy_rotation_rad"] = *c.max_proxy_rotation_rad;
  return json.dump(2) + "\n";
}

std::string comparison_to_text(const ToolComparison& c) {
  std::string text = fmt::format("force error: rms {:.3g} N, largest ({:.3g}, {:.3g}, {:.3g}) N\n", c.rms_force_error_N,
                                 c.max_force_error_N.x(), c.max_force_error_N.y(), c.max_force_error_N.z());
  text += fmt::format("torque error: rms {:.3g} mNm, largest ({:.3g}, {:.3g}, {:.3g}) mNm, {:.3g} JND, at row {}\n",
                      c.rms_torque_error_Nm * 1e3, c.max_torque_error_Nm.x() * 1e3, c.max_torque_error_Nm.y() * 1e3,
                      c.max_torque_error_Nm.z() * 1e3, c.max_torque_error_jnd, c.worst_torque_row + 1);
  if (c.max_proxy_translation_m) {
    text += fmt::format("pose of the proxy: at most {:.3g} mm and {:.3g} degrees apart\n",
                        *c.max_proxy_translation_m * 1e3, *c.max_proxy_rotation_rad * 180.0 / std::numbers::pi);
  }
  return text;
}

bool within(const ToolComparison& c, const Vec3& force_N, const Vec3& torque_Nm) {
  return (c.max_force_error_N.array() <= force_N.array()).all() &&
         (c.max_torque_error_Nm.array() <= torque_Nm.array()).all();
}

}  // namespace touchstone::tool
