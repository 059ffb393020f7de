// Residuals in blocks: samples of one recording are far from independent (tracker low-passed, force noise coloured), so
// that they are averaged over windows as long as the tracker needs for two new samples, and only blocks are counted,
// weighted, resampled and held out. A block across a gap of the clock ends there.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "harness/base/vec.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

struct ResidualBlock {
  std::size_t begin;
  std::size_t end;  // one past
};

// `window_s`: two samples of the tracker (see block_window_s).
std::vector<ResidualBlock> make_blocks(const MotionColumns& motion, double window_s);
double block_window_s(double position_rate_Hz, const MotionColumns& motion);

// Neighbouring blocks share what a model lacks: where their spread is taken, runs of this many count as one.
inline constexpr std::size_t blocks_in_run = 8;

// Mean of a series over each block.
std::vector<Vec3> block_means(const std::vector<ResidualBlock>& blocks, std::span<const Vec3> series);

// What noise alone would leave of a block's mean residual, in the contact's frame.
struct BlockNoise {
  Vec3 n_W = Vec3::Zero();      // mean normal; zero in free air: noise is then the same along all axes
  double along_normal_N = 0.0;  // standard deviations
  double tangential_N = 0.0;
  Vec3 bias_W_N = Vec3::Zero();  // mean residual that position noise brings about through the model's own bends
};

// A block's residual over its noise: a vector of unit variance per axis if nothing but noise is left.
Vec3 whitened(const Vec3& residual_W_N, const BlockNoise& noise);

}  // namespace touchstone::discrepancy
