#include "harness/discrepancy/evidence.h"

#include <algorithm>
#include <cmath>

namespace touchstone::discrepancy {

namespace {

double rms_N(const Evidence& evidence, const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  const auto& t_s = evidence.recording->motion.t_s;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!evidence.part.contains(t_s[i], t_s.front())) continue;
    sum += (a[i] - b[i]).squaredNorm();
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, count)));
}

}  // namespace

double rms_force_error_N(const Evidence& evidence, const Prediction& prediction) {
  return rms_N(evidence, evidence.recording->f_W_N, prediction.f_W_N);
}

double rms_difference_N(const Evidence& evidence, const Prediction& a, const Prediction& b) {
  return rms_N(evidence, a.f_W_N, b.f_W_N);
}

double expected_noise_N(const Evidence& evidence, const Model& model) {
  const auto squares = evidence.noise->expected_squares(model, evidence.predictor->predict(model));
  const auto& t_s = evidence.recording->motion.t_s;
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    if (!evidence.part.contains(t_s[i], t_s.front())) continue;
    sum += squares[i];
    count += 1.0;
  }
  return std::sqrt(sum / std::max(1.0, count));
}

FitData fit_data(const Evidence& evidence, const Model& model, double window_s) {
  FitData data;
  data.predictor = evidence.predictor;
  const auto& t_s = evidence.recording->motion.t_s;
  for (const ResidualBlock& block : make_blocks(evidence.recording->motion, window_s)) {
    if (evidence.part.contains(t_s[block.begin], t_s.front())) data.blocks.push_back(block);
  }
  data.measured_N = block_means(data.blocks, evidence.recording->f_W_N);
  data.noise = evidence.noise->of(model, evidence.predictor->predict(model), data.blocks);
  return data;
}

std::pair<double, double> paired_difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> sums;
  for (std::size_t i = 0; i < a.size(); i += blocks_in_run) {
    double sum = 0.0;
    for (std::size_t j = i; j < std::min(i + blocks_in_run, a.size()); ++j) sum += a[j] - b[j];
    sums.push_back(sum);
  }
  double total = 0.0;
  for (const double sum : sums) total += sum;
  const double mean = total / static_cast<double>(sums.size());
  double squares = 0.0;
  for (const double sum : sums) squares += (sum - mean) * (sum - mean);
  return {total, std::sqrt(squares)};
}

}  // namespace touchstone::discrepancy
