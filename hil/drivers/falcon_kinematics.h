// Kinematics of the Novint Falcon, a delta of three arms (Stamper 1997, "A three degree of freedom parallel manipulator
// with only translational degrees of freedom", section 2). Arm i in its own frame (u, v, w):
// (p_u + c - a cos t)^2 + (p_w - a sin t)^2 = (sqrt(b^2 - (p_v + f)^2) + d + e)^2.
//   Link lengths: libnifalcon's include/falcon/core/FalconGeometry.h as of revision f7c727a. It corrected c, r and s on
// 2009-06-23 (5ca9c0b, "Corrected values of r and s. [...] Tested.") and exchanged r and s on 2009-09-18 (935a31e). The
// values before (c 0.014, r 0.037233758, s -0.027330909) are still found in older publications; they differ by
// millimetres. Forces do not follow libnifalcon: as we read it, its jacobian() has sin(theta2)^2 where the derivative
// of its own IK has sin(theta2) sin(theta3). With that factor exchanged its first arm agrees with ours and the other
// two do not; neither was tried on a device, and its authors may mean another parametrisation. Ours is held against
// differences of the positions.
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
