#include "harness/discrepancy/holdout_judgement.h"

#include <cmath>
#include <tuple>

#include "harness/discrepancy/goodness.h"
#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/model_edit.h"

namespace touchstone::discrepancy {
namespace {

void judge_effects(const SearchData& data, int iterations, const FitData& holdout, TimeBudget& budget,
                   SearchResult& result) {
  const auto with = block_chi_squared(holdout, result.model);
  FitData learning = fit_data(data.learning, result.model, data.window_s);
  add_misfit(learning, estimate_misfit(learning, result.model));
  for (FoundEffect& effect : result.found) {
    if (!budget.allows("whether the held-out data contradict " + effect.name)) continue;
    const JointFit without =
        fit_jointly(learning, without_entry(result.model, effect.name),
                    without_coefficients(without_owner(result.parameters, effect.name)), iterations, false);
    if (!without.ok) continue;
    std::tie(effect.holdout_gain, effect.holdout_error) =
        paired_difference(block_chi_squared(holdout, without.model), with);
  }
}

}  // namespace

void judge_on_holdout(const SearchData& data, int iterations, TimeBudget& budget, SearchResult& result) {
  const Goodness goodness = judge_goodness(data.learning, data.holdout, result.model, data.window_s);
  result.goodness = goodness.chi_squared;
  result.null_goodness = goodness.null;
  result.goodness_threshold = goodness.threshold;
  result.structured_threshold = goodness.structured_threshold;
  result.law_threshold = goodness.law_threshold;
  result.noise_rms_N = goodness.noise_rms_N;
  const DetectorSide learning{data.learning.recording, &goodness.train, data.learning.noise};
  const DetectorSide holdout{data.holdout.recording, &goodness.holdout, data.holdout.noise};
  result.structure = detect_structure(learning, holdout, result.model, result.draws);
  result.spectrum = residual_spectrum(learning, holdout, result.model, data.window_s);
  judge_effects(data, iterations, goodness.holdout, budget, result);
}

void judge_law_on_holdout(const SearchData& data, SearchResult& result) {
  if (!result.law.found()) return;
  FitData learning = fit_data(data.learning, result.model, data.window_s);
  FitData holdout = fit_data(data.holdout, result.model, data.window_s);
  widen_noise(learning, fit_data(data.learning, result.law.model, data.window_s));
  widen_noise(holdout, fit_data(data.holdout, result.law.model, data.window_s));
  add_misfit(holdout, estimate_misfit(learning, result.model));
  std::tie(result.law_gain, result.law_error) =
      paired_difference(block_chi_squared(holdout, result.model), block_chi_squared(holdout, result.law.model));
  const auto square = [&](const rendering::Model& model) {
    return std::pow(rms_force_error_N(data.holdout, data.holdout.predictor->predict(model)), 2);
  };
  const double without = square(result.model);
  const double beyond = without - result.noise_rms_N * result.noise_rms_N;
  result.law_share = beyond > 0.0 ? (without - square(result.law.model)) / beyond : 0.0;
}

}  // namespace touchstone::discrepancy
