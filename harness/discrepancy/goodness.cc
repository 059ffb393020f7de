#include "harness/discrepancy/goodness.h"

#include <algorithm>
#include <array>

namespace touchstone {
namespace {

constexpr const char* path_name = "presliding_m";

bool has_path(const Model& model) {
  return std::any_of(model.effects.begin(), model.effects.end(),
                     [](const NamedParameters& entry) { return entry.parameters.contains(path_name); });
}

Model with_shorter_path(const Model& model, double share) {
  Model shorter = model;
  for (NamedParameters& entry : shorter.effects) {
    const auto path = entry.parameters.find(path_name);
    if (path != entry.parameters.end()) path->second *= share;
  }
  return shorter;
}

// The blocks with the larger of the noise of both models.
FitData blocks_under(const Evidence& evidence, const Model& model, const Model& other, double window_s) {
  FitData data = fit_data(evidence, model, window_s);
  const FitData wider = fit_data(evidence, other, window_s);
  for (std::size_t b = 0; b < data.noise.size(); ++b) {
    BlockNoise& noise = data.noise[b];
    noise.along_normal_N = std::max(noise.along_normal_N, wider.noise[b].along_normal_N);
    noise.tangential_N = std::max(noise.tangential_N, wider.noise[b].tangential_N);
  }
  return data;
}

Goodness judge_under(const Evidence& train, const Evidence& holdout, const Model& model, const Model& noisy,
                     double window_s) {
  Goodness goodness;
  goodness.train = blocks_under(train, model, noisy, window_s);
  goodness.holdout = blocks_under(holdout, model, noisy, window_s);
  const double freedom = 3.0 * static_cast<double>(std::max<std::size_t>(1, goodness.holdout.blocks.size()));
  goodness.chi_squared = chi_squared(goodness.holdout, model) / freedom;
  const Prediction nominal = holdout.predictor->predict(noisy);
  for (std::size_t world = 0; world < NoiseModel::null_worlds; ++world) {
    FitData null = goodness.holdout;
    null.measured_N = block_means(null.blocks, holdout.noise->null_forces(noisy, nominal, world));
    goodness.null = std::max(goodness.null, chi_squared(null, model) / freedom);
  }
  goodness.noise_rms_N = expected_noise_N(holdout, noisy);
  return goodness;
}

}  // namespace

double unexplained_threshold(double null_goodness) {
  return std::max(unexplained_goodness, unexplained_over_null * null_goodness);
}

Goodness judge_goodness(const Evidence& train, const Evidence& holdout, const Model& model, double window_s) {
  Goodness fitted = judge_under(train, holdout, model, model, window_s);
  if (fitted.chi_squared < unexplained_threshold(fitted.null) || !has_path(model)) return fitted;
  for (const double share : std::array{0.3, 0.1}) {
    Goodness shorter = judge_under(train, holdout, model, with_shorter_path(model, share), window_s);
    // The null worlds are another model's here: what they leave is no excuse for more.
    shorter.null = fitted.null;
    if (shorter.chi_squared < unexplained_threshold(shorter.null)) return shorter;
  }
  return fitted;
}

}  // namespace touchstone
