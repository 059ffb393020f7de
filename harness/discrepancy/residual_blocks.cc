#include "harness/discrepancy/residual_blocks.h"

#include <algorithm>

namespace touchstone::discrepancy {

double block_window_s(double position_rate_Hz, const MotionColumns& motion) {
  double window_s = 2.0 / position_rate_Hz;
  if (motion.size() > 1) {
    const double step_s = (motion.t_s.back() - motion.t_s.front()) / static_cast<double>(motion.size() - 1);
    window_s = std::max(window_s, step_s);
  }
  return window_s;
}

std::vector<ResidualBlock> make_blocks(const MotionColumns& motion, double window_s) {
  std::vector<ResidualBlock> blocks;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= motion.size(); ++i) {
    const bool full = i < motion.size() && motion.t_s[i] - motion.t_s[begin] >= window_s;
    if (i == motion.size() || full) {
      blocks.push_back({begin, i});
      begin = i;
    }
  }
  return blocks;
}

std::vector<Vec3> block_means(const std::vector<ResidualBlock>& blocks, std::span<const Vec3> series) {
  std::vector<Vec3> means;
  means.reserve(blocks.size());
  for (const ResidualBlock& block : blocks) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = block.begin; i < block.end; ++i) sum += series[i];
    means.emplace_back(sum / static_cast<double>(block.end - block.begin));
  }
  return means;
}

Vec3 whitened(const Vec3& residual_W_N, const BlockNoise& noise) {
  const Vec3 left = residual_W_N - noise.bias_W_N;
  const double normal = noise.n_W.dot(left);
  return (left - normal * noise.n_W) / noise.tangential_N + noise.n_W * (normal / noise.along_normal_N);
}

}  // namespace touchstone::discrepancy
