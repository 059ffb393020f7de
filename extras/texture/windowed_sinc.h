// The kernel by which a signal is given at other times than its samples: a sinc in a Blackman window (Oppenheim and
// Schafer, "Discrete-time signal processing", 2010, chapter 7.5).
#pragma once

#include <cmath>
#include <numbers>

namespace touchstone::texture {

// sin(pi x) / (pi x), exact at whole numbers.
inline double sinc(double x) noexcept {
  const double whole = std::round(x);
  const double angle = std::numbers::pi * (x - whole);
  if (whole == 0.0 && std::abs(angle) < 1e-9) return 1.0;
  const double sine = std::fmod(whole, 2.0) == 0.0 ? std::sin(angle) : -std::sin(angle);
  return sine / (std::numbers::pi * x);
}

// 1 in the middle, 0 from -1 and 1 on.
inline double blackman(double x) noexcept {
  if (!(std::abs(x) < 1.0)) return 0.0;
  return 0.42 + 0.5 * std::cos(std::numbers::pi * x) + 0.08 * std::cos(2.0 * std::numbers::pi * x);
}

}  // namespace touchstone::texture
