#include "harness/acquisition/frame_check.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "harness/base/error.h"

namespace touchstone::acquisition {
namespace {

// Every reading, the plainest first: of two that fit alike, the one with fewer mistakes is named.
std::vector<PoseReading> readings() {
  using enum OrientationReading;
  std::vector<PoseReading> all;
  for (const bool flip : {false, true}) {
    for (const auto orientation : {given, inverse, scalar_last}) {
      for (const auto frame : {WrenchFrame::sensor, WrenchFrame::world}) all.push_back({frame, orientation, flip});
    }
  }
  return all;
}

}  // namespace

std::string PoseReading::flags() const {
  std::string text;
  const auto add = [&](std::string_view flag) { text += fmt::format("{}{}", text.empty() ? "" : " ", flag); };
  if (flip_force) add("--flip-force");
  if (orientation == OrientationReading::inverse) add("--orientation inverse");
  if (orientation == OrientationReading::scalar_last) add("--orientation scalar-last");
  if (wrench == WrenchFrame::world) add("--wrench-frame world");
  return text;
}

std::string PoseReading::meaning() const {
  std::string text;
  const auto add = [&](std::string_view words) { text += fmt::format("{}{}", text.empty() ? "" : ", ", words); };
  if (flip_force) add("the force is reversed");
  if (orientation == OrientationReading::inverse) add("the orientation is that of the world in the sensor's frame");
  if (orientation == OrientationReading::scalar_last) add("the quaternion's columns hold x, y, z, w in this order");
  if (wrench == WrenchFrame::world) add("the wrench is already in the world's frame");
  return text;
}

std::vector<StaticPose> read_as(const std::vector<StaticPose>& poses, const PoseReading& reading) {
  std::vector<StaticPose> result = poses;
  for (StaticPose& pose : result) {
    const Quat q = pose.q_WS;
    if (reading.orientation == OrientationReading::inverse) pose.q_WS = q.conjugate();
    // The columns qw, qx, qy, qz hold x, y, z, w.
    if (reading.orientation == OrientationReading::scalar_last) pose.q_WS = Quat(q.z(), q.w(), q.x(), q.y());
    const double sign = reading.flip_force ? -1.0 : 1.0;
    const Quat turn = reading.wrench == WrenchFrame::world ? pose.q_WS.conjugate() : Quat::Identity();
    pose.measured = {sign * (turn * pose.measured.f_N), sign * (turn * pose.measured.torque_Nm)};
  }
  return result;
}

double share_of_weight_left(const ToolIdentification& found, const Vec3& gravity_W_m_per_s2) {
  const double weight_N = std::abs(found.load.mass_kg) * gravity_W_m_per_s2.norm();
  return weight_N > 0.0 ? found.fit.force_vector_N / weight_N : std::numeric_limits<double>::infinity();
}

FrameCheck check_frames(const std::vector<StaticPose>& poses, const PoseReading& reading,
                        const ToolIdentification& as_read, const Vec3& gravity_W_m_per_s2, const std::string& source) {
  FrameCheck check;
  check.share_left = share_of_weight_left(as_read, gravity_W_m_per_s2);
  const bool heavier_than_nothing = as_read.load.mass_kg > 0.0;
  check.bad_fit = !(heavier_than_nothing && check.share_left <= most_weight_left);
  if (!check.bad_fit) return check;
  // What was read is no bar: a force that does not turn with the tool fits a bias, with hardly a mass beside it.
  double best_N = std::numeric_limits<double>::infinity();
  for (const PoseReading& other : readings()) {
    if (other.flags() == reading.flags()) continue;
    try {
      const ToolIdentification found = identify_tool(read_as(poses, other), gravity_W_m_per_s2, source);
      const bool fits = found.load.mass_kg > 0.0 && share_of_weight_left(found, gravity_W_m_per_s2) <= most_weight_left;
      // Clearly better than the best so far: the first of equals stays.
      if (!fits || !(found.fit.force_vector_N < 0.9 * best_N)) continue;
      best_N = found.fit.force_vector_N;
      check.repair = other;
      check.repaired = found;
    } catch (const BadData&) {
      continue;  // read so, the orientations do not determine a tool
    }
  }
  return check;
}

std::string FrameCheck::message(const ToolIdentification& as_read, const std::string& source) const {
  if (!bad_fit) return {};
  std::string text = fmt::format(
      "{}: bad fit: the best tool ({:.3g} kg) leaves {:.3g} N per component, {:.0f} % of its weight, where a usable "
      "set of "
      "poses leaves less than {:.0f} %",
      source, as_read.load.mass_kg, as_read.fit.force_component_N, 100.0 * share_left, 100.0 * most_weight_left);
  if (!repair) {
    return text +
           "; no other frame of the wrench, reading of the orientation or sign of the force fits: was the tool "
           "touched, or are rows of force and orientation of different poses?";
  }
  const std::string flags = repair->flags();
  return text + fmt::format("; if {}, {:.3g} kg leave {:.2g} N per component: give {}",
                            repair->meaning().empty() ? "the file is read as it stands" : repair->meaning(),
                            repaired.load.mass_kg, repaired.fit.force_component_N, flags.empty() ? "no flags" : flags);
}

}  // namespace touchstone::acquisition
