#include "harness/pipeline/discrepancy/force_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/perception/filters/weber_law.h"

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

double left_in_jnd(const discrepancy::Evidence& held_out, const rendering::Prediction& prediction) {
  constexpr perception::WeberLaw fingertip = perception::fingertip_force;
  const std::vector<Vec3>& measured = held_out.recording->f_W_N;
  const std::vector<double>& t_s = held_out.recording->motion.t_s;
  double sum = 0.0;
  std::size_t felt = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!held_out.part.contains(t_s[i], t_s.front())) continue;
    if (std::max(measured[i].norm(), prediction.f_W_N[i].norm()) < fingertip.absolute_threshold) continue;
    const double in_jnd =
        (measured[i] - prediction.f_W_N[i]).norm() / fingertip.just_noticeable_difference(measured[i].norm());
    sum += in_jnd * in_jnd;
    ++felt;
  }
  return felt == 0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(sum / static_cast<double>(felt));
}

}  // namespace touchstone::pipeline
