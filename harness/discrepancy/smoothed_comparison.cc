#include "harness/discrepancy/smoothed_comparison.h"

#include <tuple>

namespace touchstone::discrepancy {

std::optional<LikelyLoss> compare_smoothed(const SearchData& data, FitData train, FitData validation,
                                           const Explanation& one, const Explanation& other, int iterations) {
  train.predictor = &data.train.noise->likely_predictor();
  validation.predictor = &data.validation.noise->likely_predictor();
  const JointFit a = fit_jointly(train, *one.model, *one.parameters, iterations, false);
  const JointFit b = fit_jointly(train, *other.model, *other.parameters, iterations, false);
  if (!a.ok || !b.ok) return std::nullopt;
  LikelyLoss loss;
  std::tie(loss.lost, loss.error) =
      paired_difference(block_chi_squared(validation, b.model), block_chi_squared(validation, a.model));
  loss.apart_N =
      rms_difference_N(data.validation, validation.predictor->predict(a.model), validation.predictor->predict(b.model));
  return loss;
}

}  // namespace touchstone::discrepancy
