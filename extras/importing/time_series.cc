#include "time_series.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace touchstone::importing {

std::vector<double> interpolated_at(const std::vector<double>& clock, const std::vector<double>& values,
                                    const std::vector<double>& at) {
  std::vector<double> out;
  out.reserve(at.size());
  std::size_t k = 0;
  for (const double t : at) {
    if (clock.size() < 2 || !(t >= clock.front()) || !(t <= clock.back())) {
      out.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    while (k + 2 < clock.size() && clock[k + 1] < t) ++k;
    const double share = (t - clock[k]) / (clock[k + 1] - clock[k]);
    out.push_back(values[k] + share * (values[k + 1] - values[k]));
  }
  return out;
}

void fill_missing(const std::vector<double>& clock, std::vector<double>& values) {
  std::size_t before = values.size();  // the last one that is there
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    for (std::size_t k = before + 1; before < values.size() && k < i; ++k) {
      const double share = (clock[k] - clock[before]) / (clock[i] - clock[before]);
      values[k] = values[before] + share * (values[i] - values[before]);
    }
    before = i;
  }
}

}  // namespace touchstone::importing
