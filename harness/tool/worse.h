// The larger of two errors; what is not a number stays.
#pragma once

#include <cmath>

namespace touchstone::tool {

inline double worse(double a, double b) { return std::isnan(a) || a > b ? a : b; }

}  // namespace touchstone::tool
