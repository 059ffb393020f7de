#include "harness/discrepancy/local_stiffness.h"

#include <algorithm>

#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {

std::vector<std::size_t> pressing_samples(const rendering::Prediction& prediction, std::size_t stride) {
  std::vector<std::size_t> pressing;
  for (std::size_t i = 0; i < prediction.n_W.size(); i += stride) {
    if (!prediction.n_W[i].isZero() && prediction.depth_m[i] > 0.0 && prediction.normal_N[i] > 0.0)
      pressing.push_back(i);
  }
  return pressing;
}

std::vector<double> stiffness_at(const rendering::Prediction& prediction, const std::vector<std::size_t>& samples) {
  constexpr double furthest = 3.0;
  std::vector<double> stiffness_N_per_m;
  stiffness_N_per_m.reserve(samples.size());
  for (const std::size_t i : samples) stiffness_N_per_m.push_back(prediction.normal_N[i] / prediction.depth_m[i]);
  if (samples.empty()) return stiffness_N_per_m;
  const double median = stats::upper_median(stiffness_N_per_m);
  for (double& one : stiffness_N_per_m) one = std::clamp(one, median / furthest, median * furthest);
  return stiffness_N_per_m;
}

}  // namespace touchstone::discrepancy
