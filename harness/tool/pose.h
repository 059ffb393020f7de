// Frames, motions and wrenches of a rigid tool: the conventions of everything with six degrees of freedom.
//
// Frames: W is the object's (world) frame, T the tool's, S a force/torque sensor's. T's origin is the handle: the point
// that the hand (or the device) holds. A pose X_WT = (p_W, q_WT) takes tool coordinates to world coordinates:
//   x_W = p_W + R_WT x_T,   R_WT the rotation of q_WT (w, x, y, z; active; X_WB = X_WA X_AB means "first AB, then WA").
// Motion: a small rotation has the vector dtheta_W (rad, right-handed, components in W) and turns about T's origin:
//   p_W <- p_W + dp_W,   R_WT <- exp([dtheta_W]x) R_WT.
// Wrench: force and torque ON the tool BY the object, components in W, the torque about the tool's origin:
//   f = sum f_i,   tau = sum (x_i - p_W) x f_i   over the contacts at x_i.
// About another point b, with r = b - a:   tau_b = tau_a - r x f   (wrench_about in harness/base/wrench.h), hence
// the wrench at the tip from the wrench that the sensor measures at its own origin, in its own axes:
//   f_W = R_WS f_S,   tau_W,tip = R_WS tau_S - (p_W,tip - p_W,S) x f_W.
// Twist: velocity v of the frame's origin and angular velocity w. From a frame B into A with X_AB = (p, R):
//   v_A = R v_B + p x R w_B,   w_A = R w_B          (the adjoint of X_AB; v is the velocity of the body point at A's
//   origin) f_A = R f_B,               tau_A = R tau_B + p x R f_B          (its inverse transpose),
// so that the power f . v + tau . w is the same in both.
// Source: Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation (1994), sections 2.4 and 2.5.
#pragma once

#include <cmath>

#include "harness/base/vec.h"
#include "harness/base/wrench.h"

namespace touchstone::tool {

struct Pose {
  Vec3 p_W_m = Vec3::Zero();
  Quat q_WT = Quat::Identity();  // turns the tool's frame into the world's

  [[nodiscard]] Vec3 to_W(const Vec3& x_T_m) const { return p_W_m + q_WT * x_T_m; }
  [[nodiscard]] Vec3 to_T(const Vec3& x_W_m) const { return q_WT.conjugate() * (x_W_m - p_W_m); }
  [[nodiscard]] Pose inverse() const { return {to_T(Vec3::Zero()), q_WT.conjugate()}; }
  [[nodiscard]] bool finite() const noexcept { return p_W_m.allFinite() && q_WT.coeffs().allFinite(); }
  // X_WA X_AB.
  friend Pose operator*(const Pose& a, const Pose& b) { return {a.to_W(b.p_W_m), (a.q_WT * b.q_WT).normalized()}; }
};

// The shortest rotation vector, angle in [0, pi] rad.
inline Vec3 rotation_vector(const Quat& q) {
  const double sine = q.vec().norm();
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  if (sine == 0.0) return Vec3::Zero();
  return (sign * 2.0 * std::atan2(sine, std::abs(q.w())) / sine) * q.vec();
}
inline Quat rotation_by(const Vec3& vector_rad) {
  const double angle = vector_rad.norm();
  // sin(a/2)/a with its limit at 0.
  const double scale = angle == 0.0 ? 0.5 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), scale * vector_rad.x(), scale * vector_rad.y(), scale * vector_rad.z()};
}

// A displacement of the tool: of its origin, and the rotation about it; components in W.
struct Displacement {
  Vec3 translation_m = Vec3::Zero();
  Vec3 rotation_rad = Vec3::Zero();
};
inline Pose moved(const Pose& from, const Displacement& by) {
  return {from.p_W_m + by.translation_m, (rotation_by(by.rotation_rad) * from.q_WT).normalized()};
}
// What takes `from` to `to`: moved(from, displacement(from, to)) is `to`.
inline Displacement displacement(const Pose& from, const Pose& to) {
  return {to.p_W_m - from.p_W_m, rotation_vector(to.q_WT * from.q_WT.conjugate())};
}

struct Twist {
  Vec3 v_m_per_s = Vec3::Zero();
  Vec3 w_rad_per_s = Vec3::Zero();
};
inline double power_W(const Wrench& wrench, const Twist& twist) {
  return dot(wrench.f_N, twist.v_m_per_s) + dot(wrench.torque_Nm, twist.w_rad_per_s);
}
// From frame B (about its origin, in its axes) into frame A; X_AB takes B's coordinates to A's.
inline Twist twist_in(const Pose& x_AB, const Twist& twist_B) {
  const Vec3 w = x_AB.q_WT * twist_B.w_rad_per_s;
  return {x_AB.q_WT * twist_B.v_m_per_s + x_AB.p_W_m.cross(w), w};
}
inline Wrench wrench_in(const Pose& x_AB, const Wrench& wrench_B) {
  return wrench_about(rotated(x_AB.q_WT, wrench_B), -x_AB.p_W_m);
}

// About the tip, components in W, from what a sensor at x_WS measures about its own origin in its own axes. The sign
// stays: a sensor that reports the load on itself by the tool gives the wrench by the object on the tool.
inline Wrench wrench_at_tip(const Wrench& wrench_S, const Pose& x_WS, const Vec3& tip_W_m) {
  return wrench_about(rotated(x_WS.q_WT, wrench_S), tip_W_m - x_WS.p_W_m);
}

}  // namespace touchstone::tool
