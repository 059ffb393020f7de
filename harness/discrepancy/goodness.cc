#include "harness/discrepancy/goodness.h"

#include <algorithm>

#include "harness/discrepancy/model_edit.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

struct Excess {
  double least;      // of chi-squared per degree of freedom, whatever the simulated recordings show
  double over_null;  // times the most that they make
  double structured_over_null;
};
constexpr Excess smooth{1.5, 1.35, 1.1};
constexpr Excess dry_friction{2.0, 2.2, 1.3};

bool has_dry_friction(const Model& model) {
  const auto coefficient = model.parameters.find("mu_dynamic");
  return has_path(model) || (coefficient != model.parameters.end() && coefficient->second > 0.0);
}

void set_thresholds(const Model& model, Goodness& goodness) {
  const bool dry = has_dry_friction(model);
  const Excess& excess = dry ? dry_friction : smooth;
  goodness.threshold = std::max(excess.least, excess.over_null * goodness.null);
  goodness.law_threshold = dry ? goodness.threshold : std::min(goodness.null, goodness.threshold);
  goodness.structured_threshold = excess.structured_over_null * goodness.null;
}

// The blocks with the larger of the noise of both models.
FitData blocks_under(const Evidence& evidence, const Model& model, const Model& other, double window_s) {
  FitData data = fit_data(evidence, model, window_s);
  widen_noise(data, fit_data(evidence, other, window_s));
  return data;
}

Goodness judge_under(const Evidence& train, const Evidence& holdout, const Model& model, const Model& noisy,
                     double window_s) {
  Goodness goodness;
  goodness.train = blocks_under(train, model, noisy, window_s);
  goodness.holdout = blocks_under(holdout, model, noisy, window_s);
  const double freedom = 3.0 * static_cast<double>(std::max<std::size_t>(1, goodness.holdout.blocks.size()));
  goodness.chi_squared = chi_squared(goodness.holdout, model) / freedom;
  const rendering::Prediction nominal = holdout.predictor->predict(noisy);
  for (std::size_t world = 0; world < NoiseModel::null_simulations; ++world) {
    FitData null = goodness.holdout;
    null.measured_N = block_means(null.blocks, holdout.noise->null_forces(noisy, nominal, world));
    goodness.null = std::max(goodness.null, chi_squared(null, model) / freedom);
  }
  goodness.noise_rms_N = expected_noise_N(holdout, noisy);
  return goodness;
}

}  // namespace

Goodness judge_goodness(const Evidence& train, const Evidence& holdout, const Model& model, double window_s) {
  Goodness fitted = judge_under(train, holdout, model, model, window_s);
  set_thresholds(model, fitted);
  if (fitted.chi_squared < fitted.threshold) return fitted;
  for (const Model& noisy : with_shorter_paths(model)) {
    Goodness shorter = judge_under(train, holdout, model, noisy, window_s);
    // The simulated recordings are another model's here: what they leave is no excuse for more.
    shorter.null = fitted.null;
    set_thresholds(model, shorter);
    if (shorter.chi_squared < shorter.threshold) return shorter;
  }
  return fitted;
}

}  // namespace touchstone::discrepancy
