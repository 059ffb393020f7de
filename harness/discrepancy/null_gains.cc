#include "harness/discrepancy/null_gains.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "harness/base/in_parallel.h"
#include "harness/discrepancy/nearby_fits.h"

namespace touchstone::discrepancy {

std::vector<double> null_gains(const NullCase& null, const RefitInWorld& refits, std::size_t first, std::size_t last) {
  const rendering::Prediction train_nominal = null.train->predictor->predict(*null.model);
  const rendering::Prediction validation_nominal = null.validation->predictor->predict(*null.model);
  const NearbyFits nearby(*null.train_blocks, *null.model, *null.parameters);
  std::vector<std::optional<double>> gains(last - first);
  const auto in_world = [&](std::size_t i) {
    recording::Recording recording = *null.train->recording;
    recording.f_W_N = null.train->noise->null_forces(*null.model, train_nominal, first + i);
    FitData train = *null.train_blocks;
    train.measured_N = block_means(train.blocks, recording.f_W_N);
    FitData validation = *null.validation_blocks;
    validation.measured_N =
        block_means(validation.blocks, null.validation->noise->null_forces(*null.model, validation_nominal, first + i));
    const JointFit base =
        nearby.usable() ? nearby.fit(train.measured_N, *null.model, null.iterations)
                        : fit_jointly(train, rendering::Model(*null.model), *null.parameters, null.iterations, false);
    if (!base.ok) return;
    const double before = chi_squared(validation, base.model);
    for (const JointFit& with : refits(train, recording, base.model)) {
      if (!with.ok) continue;
      const double gain = before - chi_squared(validation, with.model);
      gains[i] = std::max(gains[i].value_or(gain), gain);
    }
  };
  in_parallel(gains.size(), in_world, 1);
  std::vector<double> usable;
  for (const auto& gain : gains) {
    if (gain) usable.push_back(*gain);
  }
  return usable;
}

double bar_above(const std::vector<double>& gains, double deviations) {
  if (gains.size() < 2) return 0.0;
  const double n = static_cast<double>(gains.size());
  double mean = 0.0;
  // What loses in a null world gains nothing there: how much it lost says nothing of how much it may gain.
  const auto gained = [](double gain) { return std::max(0.0, gain); };
  for (const double gain : gains) mean += gained(gain) / n;
  double squares = 0.0;
  for (const double gain : gains) squares += (gained(gain) - mean) * (gained(gain) - mean);
  return mean + deviations * std::sqrt(squares / (n - 1.0));
}

}  // namespace touchstone::discrepancy
