// The sensor's dead zone (section 3.2: 0.6 N of the paper's pressure sensor): less than that reads as nothing.
#pragma once

#include <cmath>
#include <span>
#include <vector>

namespace touchstone::perception {

inline std::vector<double> sensor_dead_zone(std::span<const double> x, double zone) {
  std::vector<double> result(x.begin(), x.end());
  for (double& value : result) {
    if (std::abs(value) < zone) value = 0.0;
  }
  return result;
}

}  // namespace touchstone::perception
