#pragma once

#include <algorithm>
#include <vector>

#include "harness/base/rooms.h"

namespace touchstone::discrepancy {

// The value below which `share`, 0 to 1, of the values lie: one of them, the lower where two would do; 0 for none.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace touchstone::discrepancy
