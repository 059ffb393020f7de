#include "harness/discrepancy/noise_model.h"

#include <algorithm>
#include <cmath>

namespace touchstone {
namespace {

// The noise of neighbouring blocks is pooled, since a handful of replicas measures one block's variance badly.
constexpr std::size_t pooled_on_each_side = 3;
// Tabulated share of a declared bound ("off by at most") that is taken as its standard deviation: a uniform error.
const double bound_to_deviation = 1.0 / std::sqrt(3.0);

Vec3 mean_normal(const SampleBlock& block, const std::vector<Vec3>& n_W) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = block.begin; i < block.end; ++i) sum += n_W[i];
  return sum.norm() > 0.0 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

}  // namespace

NoiseModel::NoiseModel(const MotionColumns& motion, const InstrumentDescription& instrument, const MakePredictor& make,
                       std::size_t replicas, std::uint64_t seed)
    : instrument_(instrument), motion_(motion) {
  const Random root(seed);
  for (std::size_t r = 0; r < replicas; ++r) {
    Random random = root.stream(r);
    moved_.push_back(with_position_noise(motion, instrument, random));
    replicas_.push_back(make(moved_.back()));
    force_noise_.push_back(force_noise(motion, instrument, random));
  }
}

std::vector<BlockNoise> NoiseModel::of(const Model& model, const Prediction& nominal,
                                       const std::vector<SampleBlock>& blocks) {
  const std::size_t n = blocks.size();
  std::vector<BlockNoise> noise(n);
  std::vector<double> normal_squares(n, 0.0);
  std::vector<double> tangential_squares(n, 0.0);
  std::vector<std::vector<Vec3>> left;
  for (std::size_t r = 0; r < replicas_.size(); ++r) {
    const Prediction replica = replicas_[r]->predict(model);
    std::vector<Vec3> difference(motion_.size());
    for (std::size_t i = 0; i < difference.size(); ++i) {
      difference[i] = replica.f_W_N[i] - nominal.f_W_N[i] + force_noise_[r][i];
    }
    left.push_back(block_means(blocks, difference));
    for (std::size_t b = 0; b < n; ++b) noise[b].bias_W_N += left.back()[b] / static_cast<double>(replicas_.size());
  }
  for (std::size_t b = 0; b < n; ++b) {
    noise[b].n_W = mean_normal(blocks[b], nominal.n_W);
    for (const auto& means : left) {
      const Vec3 spread = means[b] - noise[b].bias_W_N;
      const double normal = noise[b].n_W.dot(spread);
      normal_squares[b] += normal * normal;
      tangential_squares[b] += spread.squaredNorm() - normal * normal;
    }
  }
  const double freedom = std::max(1.0, static_cast<double>(replicas_.size()) - 1.0);
  for (std::size_t b = 0; b < n; ++b) {
    const std::size_t low = b > pooled_on_each_side ? b - pooled_on_each_side : 0;
    const std::size_t high = std::min(n, b + pooled_on_each_side + 1);
    double normal = 0.0;
    double tangential = 0.0;
    double normal_axes = 0.0;
    double tangential_axes = 0.0;
    for (std::size_t j = low; j < high; ++j) {
      // Free air and contact are not pooled: contact is noisier by far.
      if (noise[j].n_W.isZero() != noise[b].n_W.isZero()) continue;
      normal += normal_squares[j];
      normal_axes += noise[j].n_W.isZero() ? 0.0 : freedom;
      tangential += tangential_squares[j];
      tangential_axes += (noise[j].n_W.isZero() ? 3.0 : 2.0) * freedom;
    }
    double depth_m = 0.0;
    double normal_N = 0.0;
    for (std::size_t i = blocks[b].begin; i < blocks[b].end; ++i) {
      depth_m += nominal.depth_m[i];
      normal_N += nominal.normal_N[i];
    }
    const double stiffness = depth_m > 0.0 ? std::abs(normal_N) / depth_m : 0.0;
    const double geometry = bound_to_deviation * instrument_.geometry_error_m * stiffness;
    // A normal that is off by an angle turns that share of the normal force into the tangent plane.
    const double samples = static_cast<double>(blocks[b].end - blocks[b].begin);
    const double leaning = instrument_.normal_error_rad * std::abs(normal_N) / samples;
    noise[b].tangential_N = std::sqrt(tangential / tangential_axes + 0.5 * leaning * leaning);
    noise[b].along_normal_N =
        normal_axes > 0.0 ? std::sqrt(normal / normal_axes + geometry * geometry) : noise[b].tangential_N;
  }
  return noise;
}

Recording NoiseModel::null_recording(const Prediction& nominal, std::size_t index) const {
  Recording recording;
  recording.motion = moved_[index];
  recording.f_W_N = nominal.f_W_N;
  for (std::size_t i = 0; i < recording.f_W_N.size(); ++i) recording.f_W_N[i] += force_noise_[index][i];
  recording.source = "simulated";
  return recording;
}

}  // namespace touchstone
