#include "synthetic/surfaces/height_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "synthetic/surfaces/roots.h"

namespace touchstone::synthetic {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// The s in [low, high] that brings the curve (s, h(s)) closest to (s0, z0): the best of both ends and of every root of
// the derivative of half the squared distance, g = (s - s0) + (h - z0) h'. |g''| <= 3 |h'| |h''| + |h - z0| |h'''|.
// curve(s) returns {h, h', h''}.
template <class Curve>
double closest_on_curve(const Curve& curve, double s0, double z0, double low, double high, double second_bound) {
  const auto squared = [&](double s) { return (s - s0) * (s - s0) + std::pow(curve(s)[0] - z0, 2); };
  const auto g = [&](double s) {
    const auto [h, h1, h2] = curve(s);
    return Jet1{(s - s0) + (h - z0) * h1, 1.0 + h1 * h1 + (h - z0) * h2};
  };
  // A distance is flat at its minimum: a root of the derivative places it to rounding, an end that is as near does not.
  std::optional<double> best;
  double best_squared = 0.0;
  const double noise = 8.0 * epsilon * (std::abs(s0) + std::abs(low) + std::abs(high));
  visit_sign_changes(g, low, high, second_bound, noise, [&](double s, bool) {
    if (const double d = squared(s); !best || d < best_squared) {
      best = s;
      best_squared = d;
    }
    return false;
  });
  const double end = squared(low) <= squared(high) ? low : high;
  if (!best || squared(end) < best_squared * (1.0 - 16.0 * epsilon)) return end;
  return *best;
}

}  // namespace

Vec2 Saddle::foot(const Vec3& p) const {
  // p - q = lambda (-c x, c y, 1) gives x = px / (1 - u), y = py / (1 + u), z = pz - u / c with u = c lambda in [-1,
  // 1]. c (pz - h(x, y)) - u = 0 falls monotonically in u.
  const auto secular = [&](double u) {
    const double x = c_ * p.x() / (1.0 - u);
    const double y = c_ * p.y() / (1.0 + u);
    return Jet1{c_ * p.z() - u - 0.5 * (x * x - y * y), -1.0 - x * x / (1.0 - u) - y * y / (1.0 + u)};
  };
  // In the planes of symmetry the equation loses its pole, and beyond the centre of curvature the foot leaves the plane
  // (on either side: the positive is taken).
  if (p.x() == 0.0) {
    const double y = 0.5 * p.y();
    const double free = 2.0 * p.z() / c_ - 2.0 / (c_ * c_) + y * y;
    if (free > 0.0) return {std::sqrt(free), y};
  }
  if (p.y() == 0.0) {
    const double x = 0.5 * p.x();
    const double free = -2.0 * p.z() / c_ - 2.0 / (c_ * c_) + x * x;
    if (free > 0.0) return {x, std::sqrt(free)};
  }
  const double u = bracketed_root(secular, -1.0, 1.0, false);
  // Next to a pole x is the cancellation-prone one: the constraint gives it from y, and the other way round.
  Vec2 foot(p.x() / (1.0 - u), p.y() / (1.0 + u));
  const double z = p.z() - u / c_;
  if (u > 0.5) {
    foot.x() = std::copysign(std::sqrt(std::max(0.0, 2.0 * z / c_ + foot.y() * foot.y())), p.x());
  } else if (u < -0.5) {
    foot.y() = std::copysign(std::sqrt(std::max(0.0, foot.x() * foot.x() - 2.0 * z / c_)), p.y());
  }
  return foot;
}

HeightField::Height GaussianBump::height(double x, double y) const {
  const double s2 = width_m_ * width_m_;
  const double h = amplitude_m_ * std::exp(-(x * x + y * y) / (2.0 * s2));
  return {h, {-x * h / s2, -y * h / s2}};
}

Vec2 GaussianBump::foot(const Vec3& p) const {
  const double r = std::hypot(p.x(), p.y());
  const Vec2 radial = r > 0.0 ? Vec2(p.x() / r, p.y() / r) : Vec2(1.0, 0.0);
  const double s2 = width_m_ * width_m_;
  const auto curve = [&](double s) {
    const double h = amplitude_m_ * std::exp(-s * s / (2.0 * s2));
    return std::array<double, 3>{h, -s * h / s2, h * (s * s / s2 - 1.0) / s2};
  };
  // From above the foot lies uphill, from below downhill and no further than the level ground is.
  const double h = curve(r)[0];
  const bool above = p.z() >= h;
  const double low = above ? 0.0 : r;
  const double high = above ? r : r + std::sqrt(h * (h - 2.0 * std::min(p.z(), 0.0)));
  // max |h'| = A e^{-1/2} / s, max |h''| = A / s^2, max |h'''| = 1.3802 A / s^3 (at s^2 = (3 - sqrt 6) s^2).
  const double reach = std::max(std::abs(p.z()), std::abs(p.z() - amplitude_m_));
  const double second =
      (3.0 * amplitude_m_ * std::exp(-0.5) * amplitude_m_ + reach * 1.3802 * amplitude_m_) / (s2 * width_m_);
  return radial * closest_on_curve(curve, r, p.z(), low, high, second);
}

HeightField::Height Sinusoid::height(double x, double) const {
  const double k = 2.0 * std::numbers::pi / wavelength_m_;
  return {amplitude_m_ * std::sin(k * x), {amplitude_m_ * k * std::cos(k * x), 0.0}};
}

double Sinusoid::second_derivative_bound(const Vec2& d) const {
  const double k = 2.0 * std::numbers::pi / wavelength_m_;
  return amplitude_m_ * k * k * d.x() * d.x();
}

Vec2 Sinusoid::foot(const Vec3& p) const {
  const double k = 2.0 * std::numbers::pi / wavelength_m_;
  const auto curve = [&](double s) {
    const double sine = amplitude_m_ * std::sin(k * s);
    return std::array<double, 3>{sine, amplitude_m_ * k * std::cos(k * s), -k * k * sine};
  };
  // The nearest crest, trough or crossing of level z is within half a wavelength, so the foot is too.
  const double half = 0.5 * wavelength_m_;
  const double second = amplitude_m_ * k * k * k * (3.0 * amplitude_m_ + std::abs(p.z()) + amplitude_m_);
  return {closest_on_curve(curve, p.x(), p.z(), p.x() - half, p.x() + half, second), p.y()};
}

}  // namespace touchstone::synthetic
