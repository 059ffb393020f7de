#include "harness/perception/judge/growth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::perception {

GrowthBounds growth_bounds(double speed, double power) {
  constexpr double steeper = 8.0;
  const double distance = std::min(1.0, std::abs(std::log(speed)) / std::numbers::ln2);
  const double slow = std::pow(speed, power * (1.0 - distance));
  const double steep = std::pow(speed, power + steeper * distance);
  return {std::pow(speed, power), std::min(slow, steep), std::max(slow, steep)};
}

}  // namespace touchstone::perception
