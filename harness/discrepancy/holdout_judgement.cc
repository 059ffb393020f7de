#include "harness/discrepancy/holdout_judgement.h"

#include <tuple>

#include "harness/discrepancy/goodness.h"
#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/model_edit.h"

namespace touchstone::discrepancy {
namespace {

void judge_effects(const SearchData& data, int iterations, const FitData& holdout, SearchResult& result) {
  const auto with = block_chi_squared(holdout, result.model);
  FitData learning = fit_data(data.learning, result.model, data.window_s);
  add_misfit(learning, estimate_misfit(learning, result.model));
  for (FoundEffect& effect : result.found) {
    const JointFit without =
        fit_jointly(learning, without_entry(result.model, effect.name),
                    without_coefficients(without_owner(result.parameters, effect.name)), iterations, false);
    if (!without.ok) continue;
    std::tie(effect.holdout_gain, effect.holdout_error) =
        paired_difference(block_chi_squared(holdout, without.model), with);
  }
}

}  // namespace

void judge_on_holdout(const SearchData& data, int iterations, SearchResult& result) {
  const Goodness goodness = judge_goodness(data.learning, data.holdout, result.model, data.window_s);
  result.goodness = goodness.chi_squared;
  result.null_goodness = goodness.null;
  result.goodness_threshold = goodness.threshold;
  result.structured_threshold = goodness.structured_threshold;
  result.noise_rms_N = goodness.noise_rms_N;
  const DetectorSide learning{data.learning.recording, &goodness.train, data.learning.noise};
  const DetectorSide holdout{data.holdout.recording, &goodness.holdout, data.holdout.noise};
  result.structure = detect_structure(learning, holdout, result.model, result.draws);
  result.spectrum = residual_spectrum(learning, holdout, result.model, data.window_s);
  judge_effects(data, iterations, goodness.holdout, result);
}

}  // namespace touchstone::discrepancy
