#include "harness/discrepancy/evidence.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::Prediction;

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

// Of a part: a second of a hand's motion goes there and back, so that both kinds of blocks see every place, and is long
// against the noise of a force sensor and its tracker. A short recording has shorter ones.
constexpr double longest_block_s = 1.0;
constexpr double least_blocks = 16.0;

// So that a whole even number of blocks fits into a block of what is learnt from.
double validation_block_s(const Evidence& learning) {
  const auto& t_s = learning.recording->motion.t_s;
  const double within_s = learning.part.blocks.block_s;
  const double longest_s = std::min(longest_block_s, (t_s.back() - t_s.front()) / least_blocks);
  return within_s > 0.0 ? 0.5 * within_s / std::ceil(0.5 * within_s / longest_s) : longest_s;
}

// The differences a - b, summed over runs of neighbouring blocks.
std::vector<double> differences_of_runs(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> sums;
  for (std::size_t i = 0; i < a.size(); i += blocks_in_run) {
    double sum = 0.0;
    for (std::size_t j = i; j < std::min(i + blocks_in_run, a.size()); ++j) sum += a[j] - b[j];
    sums.push_back(sum);
  }
  return sums;
}

}  // namespace

SearchData divide(const Evidence& learning, const Evidence& holdout, double window_s) {
  SearchData data;
  data.learning = data.train = data.validation = learning;
  data.holdout = holdout;
  data.window_s = window_s;
  data.train.part.within = {validation_block_s(learning), false};
  data.validation.part.within = {validation_block_s(learning), true};
  return data;
}

namespace {

template <class Value>
std::vector<Value> values_of(const Part& part, const MotionColumns& motion, const std::vector<Value>& values) {
  std::vector<Value> some;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (part.contains(motion.t_s[i], motion.t_s.front())) some.push_back(values[i]);
  }
  return some;
}

}  // namespace

Recording samples_of(const Part& part, const Recording& recording) {
  const MotionColumns& all = recording.motion;
  Recording some;
  some.motion = {values_of(part, all, all.t_s), values_of(part, all, all.p_W_m), values_of(part, all, all.q_WS)};
  some.f_W_N = values_of(part, all, recording.f_W_N);
  some.source = recording.source;
  return some;
}

Prediction samples_of(const Part& part, const MotionColumns& motion, const Prediction& prediction) {
  return {values_of(part, motion, prediction.f_W_N), values_of(part, motion, prediction.n_W),
          values_of(part, motion, prediction.depth_m), values_of(part, motion, prediction.normal_N)};
}

double rms_force_error_N(const Evidence& evidence, const Prediction& prediction) {
  return rms_N(evidence, evidence.recording->f_W_N, prediction.f_W_N);
}

double rms_difference_N(const Evidence& evidence, const Prediction& a, const Prediction& b) {
  return rms_N(evidence, a.f_W_N, b.f_W_N);
}

double expected_noise_N(const Evidence& evidence, const rendering::Model& model) {
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

FitData fit_data(const Evidence& evidence, const rendering::Model& model, double window_s) {
  FitData data;
  data.predictor = evidence.predictor;
  const auto& t_s = evidence.recording->motion.t_s;
  for (const ResidualBlock& block : make_blocks(evidence.recording->motion, window_s)) {
    // One across the border of a part is in neither.
    if (evidence.part.contains(t_s[block.begin], t_s.front()) &&
        evidence.part.contains(t_s[block.end - 1], t_s.front())) {
      data.blocks.push_back(block);
    }
  }
  data.measured_N = block_means(data.blocks, evidence.recording->f_W_N);
  data.noise = evidence.noise->of(model, evidence.predictor->predict(model), data.blocks);
  return data;
}

void widen_noise(FitData& data, const FitData& other) {
  for (std::size_t b = 0; b < data.noise.size(); ++b) {
    BlockNoise& noise = data.noise[b];
    noise.along_normal_N = std::max(noise.along_normal_N, other.noise[b].along_normal_N);
    noise.tangential_N = std::max(noise.tangential_N, other.noise[b].tangential_N);
  }
}

std::pair<double, double> paired_difference(const std::vector<double>& a, const std::vector<double>& b) {
  const std::vector<double> sums = differences_of_runs(a, b);
  double total = 0.0;
  for (const double sum : sums) total += sum;
  const double mean = total / static_cast<double>(sums.size());
  double squares = 0.0;
  for (const double sum : sums) squares += (sum - mean) * (sum - mean);
  return {total, std::sqrt(squares)};
}

// With g of n runs left out on each side, h = n - 2 g: the mean m of the h, and the squares of all n about their mean
// with the outer g set to the nearest of the h (Winsor). The error of m is sqrt(squares / (h (h - 1))).
std::pair<double, double> trimmed_difference(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr std::size_t fewest = 8;
  constexpr std::size_t one_of = 30;
  std::vector<double> sums = differences_of_runs(a, b);
  const std::size_t n = sums.size();
  if (n < fewest) return paired_difference(a, b);
  std::sort(sums.begin(), sums.end());
  const std::size_t g = std::max<std::size_t>(1, n / one_of);
  const auto h = static_cast<double>(n - 2 * g);
  double trimmed = 0.0;
  for (std::size_t i = g; i < n - g; ++i) trimmed += sums[i];
  for (std::size_t i = 0; i < g; ++i) {
    sums[i] = sums[g];
    sums[n - 1 - i] = sums[n - 1 - g];
  }
  const double all = static_cast<double>(n);
  const double mean = std::accumulate(sums.begin(), sums.end(), 0.0) / all;
  double squares = 0.0;
  for (const double sum : sums) squares += (sum - mean) * (sum - mean);
  return {all * trimmed / h, all * std::sqrt(squares / (h * (h - 1.0)))};
}

}  // namespace touchstone::discrepancy
