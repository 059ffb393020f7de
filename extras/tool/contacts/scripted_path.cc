#include "contacts/scripted_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::contacts {
using tool::Pose;

Pose scripted_pose(const ExactCase& exact_case, double t_s, double duration_s) {
  const std::size_t legs = exact_case.handles.size() + 1;
  const double along = std::clamp(t_s / duration_s, 0.0, 1.0) * double(legs);
  const auto leg = std::min(static_cast<std::size_t>(along), legs - 1);
  const double s = along - double(leg);
  const double share = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  const Pose& from = leg == 0 ? exact_case.free : exact_case.handles[leg - 1];
  const Pose& to = leg + 1 == legs ? exact_case.free : exact_case.handles[leg];
  const tool::Displacement way = displacement(from, to);
  const Pose on_the_way = moved(from, {share * way.translation_m, share * way.rotation_rad});
  constexpr double circle_m = 0.3e-3;
  constexpr double circle_rad = 0.01;
  constexpr double circle_Hz = 0.7;
  constexpr double tremor_m = 0.05e-3;
  constexpr double tremor_rad = 2e-3;
  constexpr double tremor_Hz = 9.0;
  // From nothing at both ends, where the tool must be free.
  const double grown = std::sin(std::numbers::pi * std::clamp(t_s / duration_s, 0.0, 1.0));
  const double a = 2.0 * std::numbers::pi * circle_Hz * t_s;
  const double b = 2.0 * std::numbers::pi * tremor_Hz * t_s;
  return moved(on_the_way,
               {grown * Vec3(circle_m * std::cos(a), circle_m * std::sin(a), tremor_m * std::sin(b)),
                grown * Vec3(circle_rad * std::sin(a), tremor_rad * std::sin(b), circle_rad * std::cos(a))});
}

}  // namespace touchstone::contacts
