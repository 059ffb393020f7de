// Noise of simulated series of builds, for the tests of false alarms and of detection: unit standard deviation, except
// where it has none.
#pragma once

#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::change_points {

// normal; Laplace; Student's t with 3 degrees of freedom; log-normal (skewed); two modes at random; normal rounded to
// half a standard deviation; 2 % outliers of ten standard deviations; correlation 0.3 from build to build.
inline constexpr std::array<std::string_view, 8> noises{"normal",    "laplace", "t3",       "lognormal",
                                                        "two-modes", "rounded", "outliers", "correlated"};

inline double draw(std::string_view noise, Random& random) {
  const double z = random.normal();
  if (noise == "laplace")
    return (random.uniform() < 0.5 ? -1.0 : 1.0) * -std::log(1.0 - random.uniform()) / std::sqrt(2.0);
  if (noise == "t3") {
    double squares = 0.0;
    for (int i = 0; i < 3; ++i) squares += std::pow(random.normal(), 2);
    return z / std::sqrt(squares / 3.0) / std::sqrt(3.0);
  }
  if (noise == "lognormal") return (std::exp(0.5 * z) - std::exp(0.125)) / std::sqrt(std::exp(0.25) * std::expm1(0.25));
  if (noise == "two-modes") return (random.uniform() < 0.5 ? -0.9 : 0.9) + std::sqrt(0.19) * z;
  if (noise == "rounded") return std::round(2.0 * z) / 2.0;
  if (noise == "outliers") return random.uniform() < 0.02 ? 10.0 * z : z;
  return z;
}

inline std::vector<double> series_of(std::string_view noise, std::size_t count, Random& random) {
  constexpr double correlation = 0.3;
  std::vector<double> values(count);
  double last = random.normal();
  for (double& value : values) {
    value = draw(noise, random);
    if (noise == "correlated") value = last = correlation * last + std::sqrt(1.0 - correlation * correlation) * value;
  }
  return values;
}

}  // namespace touchstone::change_points
