#include "synthetic/trajectories/presses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/random.h"

namespace touchstone::synthetic {

Vec3 TapPath::position_W_m(double t_s) const {
  const double t = std::clamp(t_s, 0.0, duration_s());
  const double down = 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * t / period_s_));
  return {0.0, 0.0, height_m_ - (height_m_ + depth_m_) * down};
}

Vec3 PushPath::position_W_m(double t_s) const {
  const double stroke = height_m_ + depth_m_;
  const double travelled = speed_m_per_s_ * std::clamp(t_s, 0.0, duration_s());
  const double down = std::min(travelled, stroke);
  const double aside = std::clamp(travelled - stroke, 0.0, shift_m_);
  const double up = std::max(0.0, travelled - stroke - shift_m_);
  return {aside, 0.0, height_m_ - down + up};
}

Vec3 JumpPath::position_W_m(double t_s) const {
  const double jump = std::clamp(std::floor(t_s / rest_s_), 0.0, jumps_ - 1.0);
  Random random = Random(seed_).stream(static_cast<std::uint64_t>(jump));
  const double x = random.uniform(-0.5, 0.5) * side_m_;
  const double y = random.uniform(-0.5, 0.5) * side_m_;
  return {x, y, random.uniform(-depth_m_, height_m_)};
}

namespace {

// The arc length of r = angle from the middle, over its slope at infinity: (x sqrt(1 + x^2) + asinh x) / 2.
double spiral_length(double angle) { return 0.5 * (angle * std::sqrt(1.0 + angle * angle) + std::asinh(angle)); }

}  // namespace

double SpiralPath::duration_s() const {
  const double last = 2.0 * std::numbers::pi * turns_;
  return radius_m_ / last * spiral_length(last) / speed_m_per_s_;
}

Vec3 SpiralPath::position_W_m(double t_s) const {
  const double last = 2.0 * std::numbers::pi * turns_;
  const double length = std::clamp(t_s / duration_s(), 0.0, 1.0) * spiral_length(last);
  // Newton on a convex function from above: monotone.
  double angle = std::min(last, std::sqrt(2.0 * length));
  for (int i = 0; i < 60; ++i) {
    const double next = angle - (spiral_length(angle) - length) / std::sqrt(1.0 + angle * angle);
    if (std::abs(next - angle) <= 1e-16 * last) break;
    angle = next;
  }
  const double r = radius_m_ / last * angle;
  return {r * std::cos(angle), r * std::sin(angle), -depth_m_};
}

}  // namespace touchstone::synthetic
