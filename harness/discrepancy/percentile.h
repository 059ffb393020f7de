#pragma once

#include <utility>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {

// The value below which `share`, 0 to 1, of the values lie: one of them, the lower where two would do; 0 for none.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  return stats::lower_quantile(std::move(values), share);
}

}  // namespace touchstone::discrepancy
