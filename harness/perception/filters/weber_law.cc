#include "harness/perception/filters/weber_law.h"

#include <algorithm>
#include <cmath>

namespace touchstone::perception {

double WeberLaw::fraction(double intensity) const noexcept {
  return std::abs(intensity) > breakpoint ? fraction_above : fraction_below;
}

double WeberLaw::just_noticeable_difference(double intensity) const noexcept {
  const double magnitude = std::abs(intensity);
  return magnitude < absolute_threshold ? absolute_threshold : fraction(intensity) * magnitude;
}

double WeberLaw::steps(double intensity) const noexcept {
  const double magnitude = std::abs(intensity);
  if (magnitude <= absolute_threshold) return intensity / absolute_threshold;
  double steps = 1.0 + std::log(std::min(magnitude, breakpoint) / absolute_threshold) / std::log1p(fraction_below);
  if (magnitude > breakpoint) steps += std::log(magnitude / breakpoint) / std::log1p(fraction_above);
  return std::copysign(steps, intensity);
}

}  // namespace touchstone::perception
