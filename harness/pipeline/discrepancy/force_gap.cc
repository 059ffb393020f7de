#include "harness/pipeline/discrepancy/force_gap.h"

#include <cmath>

namespace touchstone::pipeline {

MeasuredGap measure_gap(const discrepancy::SearchResult& search, const discrepancy::SearchData& data,
                        const HeldOutSamples& held_out) {
  const auto rms_N = [](const discrepancy::Evidence& evidence, const rendering::Model& model) {
    return rms_force_error_N(evidence, evidence.predictor->predict(model));
  };
  MeasuredGap measured{{}, held_out.samples};
  discrepancy::ForceGap& gap = measured.gap;
  gap.train_before_N = rms_N(data.learning, search.start);
  gap.train_after_N = rms_N(data.learning, search.model);
  gap.holdout_before_N = rms_N(held_out.samples, search.start);
  gap.holdout_after_N = rms_N(held_out.samples, search.model);
  gap.noise_floor_N = std::sqrt(search.noise_rms_N * search.noise_rms_N + held_out.square_beyond_means_N2);
  if (held_out.count <= 1 || !gap.rises() || search.spectrum.far_above_noise()) return measured;
  discrepancy::ForceGap of_means = gap;
  of_means.holdout_before_N = rms_N(data.holdout, search.start);
  of_means.holdout_after_N = rms_N(data.holdout, search.model);
  of_means.noise_floor_N = search.noise_rms_N;
  of_means.means = {held_out.count, gap.holdout_before_N, gap.holdout_after_N};
  if (of_means.rises()) return measured;
  return {of_means, data.holdout};
}

}  // namespace touchstone::pipeline
