#include "harness/rendering/surface_frame.h"

#include <algorithm>
#include <array>

namespace touchstone::rendering {
namespace {

constexpr std::array origin_names{"frame_x_m", "frame_y_m", "frame_z_m"};
constexpr std::array turn_names{"frame_rx_rad", "frame_ry_rad", "frame_rz_rad"};

Vec3 three(const std::map<std::string, double>& parameters, const std::array<const char*, 3>& names) {
  Vec3 value = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const auto given = parameters.find(names.at(static_cast<std::size_t>(axis)));
    if (given != parameters.end()) value[axis] = given->second;
  }
  return value;
}

SurfaceFrame frame_at(const Vec3& origin_W_m, const Vec3& turn_W_rad) {
  const double angle_rad = turn_W_rad.norm();
  if (!(angle_rad > 0.0)) return {origin_W_m, Quat::Identity()};
  return {origin_W_m, Quat(Eigen::AngleAxisd(angle_rad, turn_W_rad / angle_rad))};
}

}  // namespace

SurfaceFrame SurfaceFrame::facing(const Vec3& normal_W, const Vec3& origin_W_m) {
  return {origin_W_m, Quat::FromTwoVectors(Vec3::UnitZ(), normal_W)};
}

std::vector<ParameterDeclaration> with_frame(std::vector<ParameterDeclaration> map) {
  constexpr double farthest_m = 1e6;
  constexpr double whole_turn_rad = 6.3;
  for (const char* const name : origin_names)
    map.push_back({name, "m", -farthest_m, farthest_m, 0.0, "origin of the map's x and y, in the object's frame"});
  for (const char* const name : turn_names) {
    map.push_back({name, "rad", -whole_turn_rad, whole_turn_rad, 0.0,
                   "rotation vector: turns the object's axes into those of the map's x and y"});
  }
  return map;
}

bool has_frame(const std::vector<ParameterDeclaration>& declared) {
  return std::ranges::any_of(declared, [](const auto& one) { return one.name == turn_names.front(); });
}

SurfaceFrame frame_of(const std::map<std::string, double>& parameters) {
  return frame_at(three(parameters, origin_names), three(parameters, turn_names));
}

SurfaceFrame frame_of(std::span<const double> values) {
  const auto last = values.last<6>();
  return frame_at(Vec3(last[0], last[1], last[2]), Vec3(last[3], last[4], last[5]));
}

void add_frame(const SurfaceFrame& frame, std::map<std::string, double>& parameters) {
  if (frame.is_objects()) return;
  const Eigen::AngleAxisd turn(frame.q_WF);
  const Vec3 turn_W_rad = turn.angle() * turn.axis();
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    parameters[origin_names.at(i)] = frame.origin_W_m[axis];
    parameters[turn_names.at(i)] = turn_W_rad[axis];
  }
}

ObjectDisplacement displacement_of(const std::map<std::string, double>& parameters) {
  return {three(parameters, {"dx_m", "dy_m", "dz_m"}), three(parameters, {"rx_rad", "ry_rad", "rz_rad"}),
          three(parameters, {"pivot_x_m", "pivot_y_m", "pivot_z_m"})};
}

}  // namespace touchstone::rendering
