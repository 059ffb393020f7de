// Stevens' power law (eq 4; Stevens 1957): the felt intensity phi(I) = k I^alpha.
#pragma once

#include <cmath>

namespace touchstone::perception {

struct StevensPowerLaw {
  double k;
  double alpha;

  // Odd in the stimulus: a pull feels as strong as a push.
  [[nodiscard]] double operator()(double intensity) const noexcept {
    return std::copysign(k * std::pow(std::abs(intensity), alpha), intensity);
  }
  [[nodiscard]] double inverse(double felt) const noexcept {
    return std::copysign(std::pow(std::abs(felt) / k, 1.0 / alpha), felt);
  }
};

// Exponents from Stevens, "Psychophysics" (1975), table 1: static muscle contraction, lifted weight, finger span.
inline constexpr double stevens_muscle_force = 1.7;
inline constexpr double stevens_heaviness = 1.45;
inline constexpr double stevens_finger_span = 1.3;

}  // namespace touchstone::perception
