// Evenly spaced numbers at which a test tries something, both ends included.
#pragma once

#include <vector>

namespace touchstone::testing {

// first + i step below `end`. Counted: adding a step again and again adds up its roundings, and may visit one more.
inline std::vector<double> steps(double first, double end, double step) {
  std::vector<double> places;
  for (int i = 0; first + i * step < end; ++i) places.push_back(first + i * step);
  return places;
}

}  // namespace touchstone::testing
