// Kinematics of the Novint Falcon, a delta of three arms (Stamper 1997, "A three degree of freedom parallel manipulator
// with only translational degrees of freedom", section 2; link lengths as libnifalcon publishes them). Arm i in its own
// frame (u, v, w): (p_u + c - a cos t)^2 + (p_w - a sin t)^2 = (sqrt(b^2 - (p_v + f)^2) + d + e)^2.
#pragma once

#include <array>
#include <optional>

#include "harness/base/vec.h"

namespace touchstone::hil::falcon {

using Angles = std::array<double, 3>;  // of the motors' arms [rad]

// Position to angles; nothing where the arms do not reach.
std::optional<Angles> inverse(const Vec3& p_m);
// Angles to position by Newton's method from `guess`; nothing where it does not converge.
std::optional<Vec3> forward(const Angles& angles_rad, const Vec3& guess_m);
// d(angle)/d(position) [rad/m].
Mat3 jacobian(const Vec3& p_m, const Angles& angles_rad);
// Motor torques [N m] that give this force at the handle: tau = J^-T F.
Vec3 motor_torques(const Vec3& p_m, const Angles& angles_rad, const Vec3& f_N);

// Encoder counts to arm angles: 4 x 320 counts per motor turn, 14.25 mm capstan on a 110 mm drum, 35 degrees at zero.
double angle_of_count(int count);
int count_of_angle(double angle_rad);

}  // namespace touchstone::hil::falcon
