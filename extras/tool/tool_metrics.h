// How far two answers to one path of a tool are apart: force, torque, and the pose of the proxy.
//
// Just noticeable difference of a torque: 12.7 % at a reference of 60 mNm between thumb and index finger (Jandura and
// Srinivasan, Experiments on Human Performance in Torque Discrimination and Control, 1994). Below the reference the
// difference at the reference is used, 7.6 mNm: Weber's law does not hold towards zero, and nothing was measured there.
//
// The hand feels the proxy's pose through the coupling alone (coupling.h): a proxy that is off by dp and by the
// rotation vector dw changes the force by k_t dp and the torque by k_r dw. These stand in just noticeable differences
// of the expected force (a fingertip's: harness/perception/filters/weber_law.h) and torque.
#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/tool/coupling.h"
#include "harness/tool/pose.h"
#include "harness/tool/worse.h"

namespace touchstone::tool {

inline constexpr double torque_weber_fraction = 0.127;
inline constexpr double torque_reference_Nm = 0.060;
double torque_error_in_jnd(const Vec3& expected_Nm, const Vec3& obtained_Nm);
double force_error_in_jnd(const Vec3& expected_N, const Vec3& obtained_N);

struct ToolComparison {
  std::size_t samples = 0;
  double rms_force_error_N = 0.0;
  double rms_torque_error_Nm = 0.0;
  Vec3 max_force_error_N = Vec3::Zero();    // per axis, absolute
  Vec3 max_torque_error_Nm = Vec3::Zero();  // per axis, absolute
  std::size_t worst_torque_row = 0;         // from 0
  double max_torque_error_jnd = 0.0;
  double max_force_error_jnd = 0.0;
  // Of the proxy's pose; only if both files of it are given.
  std::optional<double> max_proxy_translation_m;
  std::optional<double> max_proxy_rotation_rad;
  std::optional<double> max_proxy_translation_jnd;  // of force, through the coupling
  std::optional<double> max_proxy_rotation_jnd;     // of torque, through the coupling
};

// Both with torque and the same times. Throws BadData naming the file and row where they are not.
ToolComparison compare_tools(const recording::Recording& expected, const recording::Recording& obtained);
// Adds the errors of the proxy's pose. `wrenches`: the expected force and torque, samples as in `expected`.
void compare_proxies(const recording::InTrajectory& expected, const recording::InTrajectory& obtained,
                     const recording::Recording& wrenches, const Coupling& coupling, ToolComparison& comparison);

std::string comparison_to_json(const ToolComparison& comparison);
// The errors for people, a line each.
std::string comparison_to_text(const ToolComparison& comparison);

// No component of an error is above the tolerance of its axis; an error that is not a number is.
bool within(const ToolComparison& comparison, const Vec3& force_N, const Vec3& torque_Nm);

}  // namespace touchstone::tool
