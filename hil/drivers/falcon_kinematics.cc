#include "drivers/falcon_kinematics.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace touchstone::hil::falcon {
namespace {

constexpr double a = 0.060, b = 0.1025, c = 0.01443, d = 0.01125, e = 0.01125, f = -0.025, r = 0.0400, s = -0.02309;
constexpr double pi = std::numbers::pi;
constexpr std::array<double, 3> phi{pi / 2 + pi / 12, -pi / 6 + pi / 12, -5 * pi / 6 + pi / 12};

struct Arm {
  double u, v, w;
};
Arm arm_frame(std::size_t i, const Vec3& p) {
  return {-r + std::cos(phi[i]) * p.x() + std::sin(phi[i]) * p.y(),
          -s + std::cos(phi[i]) * p.y() - std::sin(phi[i]) * p.x(), p.z()};
}

}  // namespace

std::optional<Angles> inverse(const Vec3& p_m) {
  Angles angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Arm arm = arm_frame(i, p_m);
    const double across = arm.v + f;
    if (!(std::abs(across) < b)) return std::nullopt;
    const double length = std::sqrt(b * b - across * across) + d + e, x = arm.u + c, z = arm.w;
    const double reach = std::hypot(x, z), k = (a * a + x * x + z * z - length * length) / (2 * a);
    if (!(std::abs(k) <= reach)) return std::nullopt;
    angles[i] = std::atan2(z, x) - std::acos(k / reach);
  }
  return angles;
}

Mat3 jacobian(const Vec3& p_m, const Angles& angles_rad) {
  Mat3 j;
  for (std::size_t i = 0; i < 3; ++i) {
    const Arm arm = arm_frame(i, p_m);
    const double across = arm.v + f, shin = std::sqrt(b * b - across * across), length = shin + d + e, x = arm.u + c,
                 z = arm.w;
    const double cosine = std::cos(angles_rad[i]), sine = std::sin(angles_rad[i]),
                 denominator = a * (x * sine - z * cosine);
    const double du = -(x - a * cosine) / denominator, dv = -length * across / shin / denominator,
                 dw = -(z - a * sine) / denominator;
    j.row(static_cast<Eigen::Index>(i)) =
        Vec3(du * std::cos(phi[i]) - dv * std::sin(phi[i]), du * std::sin(phi[i]) + dv * std::cos(phi[i]), dw)
            .transpose();
  }
  return j;
}

std::optional<Vec3> forward(const Angles& angles_rad, const Vec3& guess_m) {
  Vec3 p = guess_m;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const auto now = inverse(p);
    if (!now) return std::nullopt;
    const Vec3 off((*now)[0] - angles_rad[0], (*now)[1] - angles_rad[1], (*now)[2] - angles_rad[2]);
    Vec3 step = jacobian(p, *now).inverse() * off;
    if (!step.allFinite()) return std::nullopt;
    // Within reach of the arms: no step beyond 2 cm.
    if (step.norm() > 0.02) step *= 0.02 / step.norm();
    p -= step;
    if (step.norm() < 1e-12) return p;
  }
  return std::nullopt;
}

Vec3 motor_torques(const Vec3& p_m, const Angles& angles_rad, const Vec3& f_N) {
  return jacobian(p_m, angles_rad).transpose().inverse() * f_N;
}

namespace {
constexpr double rad_per_count = 2 * pi / (4 * 320) * 0.01425 / 0.110;
constexpr double zero_angle = 35.0 / 180.0 * pi;
}  // namespace

double angle_of_count(int count) { return zero_angle + rad_per_count * count; }
int count_of_angle(double angle_rad) { return static_cast<int>(std::lround((angle_rad - zero_angle) / rad_per_count)); }

}  // namespace touchstone::hil::falcon
