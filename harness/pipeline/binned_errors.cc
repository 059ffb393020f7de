#include "harness/pipeline/binned_errors.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace touchstone::pipeline {

double BinnedErrors::rms_N() const {
  const auto n = static_cast<double>(std::accumulate(samples.begin(), samples.end(), std::uint64_t{0}));
  if (!(n > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(std::accumulate(squares_N2.begin(), squares_N2.end(), 0.0) / n);
}

void ErrorBinner::add(double t_s, double squared_N2) {
  if (errors_.samples.empty()) first_t_s_ = t_s;
  const auto bin = static_cast<std::int64_t>(std::floor((t_s - first_t_s_) / bin_s_));
  if (errors_.samples.empty() || bin != bin_) {
    errors_.squares_N2.push_back(0.0);
    errors_.samples.push_back(0);
    bin_ = bin;
  }
  errors_.squares_N2.back() += squared_N2;
  ++errors_.samples.back();
}

}  // namespace touchstone::pipeline
