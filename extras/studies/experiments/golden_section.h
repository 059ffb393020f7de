// The place where a function of one number is least, by golden-section search (Kiefer 1953).
#pragma once

#include <cmath>
#include <stdexcept>

namespace touchstone::experiments {

// f falls to its least value between low and high and rises from it: golden-section search (Kiefer 1953). The place is
// found within tolerance / 2, as far as f's own rounding lets its values be told apart.
template <class Function>
double golden_section(const Function& f, double low, double high, double tolerance) {
  if (!(low <= high) || !(tolerance > 0.0)) throw std::invalid_argument("golden_section: no interval or no tolerance");
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double x = high - ratio * (high - low);
  double y = low + ratio * (high - low);
  double fx = f(x);
  double fy = f(y);
  // Beyond rounding an interval does not shrink any more.
  while (high - low > tolerance && low < x && x < y && y < high) {
    if (fx < fy) {
      high = y;
      y = x;
      fy = fx;
      x = high - ratio * (high - low);
      fx = f(x);
    } else {
      low = x;
      x = y;
      fx = fy;
      y = low + ratio * (high - low);
      fy = f(y);
    }
  }
  return 0.5 * (low + high);
}

}  // namespace touchstone::experiments
