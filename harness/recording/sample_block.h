// Consecutive samples of a recording or a rendered trajectory, column by column: what streams read and write. SI units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "harness/base/vec.h"
#include "harness/recording/trajectory.h"

namespace touchstone::recording {

// Vectors of columns that the file does not have are empty; the others have one length.
struct SampleBlock {
  std::uint64_t first_sample = 0;  // how many samples came before
  MotionColumns motion;
  std::vector<Vec3> f_W_N;
  std::vector<Vec3> torque_W_Nm;
  std::vector<Vec3> contact_W_m;  // surface contact point
  std::vector<unsigned char> contact;
  std::vector<double> cost_us;

  [[nodiscard]] std::size_t size() const noexcept { return motion.size(); }
  void clear();
  // Appends samples [begin, end) of a block with the same columns.
  void append(const SampleBlock& other, std::size_t begin, std::size_t end);
  void append(const SampleBlock& other) { append(other, 0, other.size()); }
  // Appends one sample: the mean of [begin, end), at the time of the first. Orientation is the normalised sum of the
  // quaternions (the mean to second order in their spread); contact is 1 where any is.
  void append_mean(const SampleBlock& other, std::size_t begin, std::size_t end);
};

}  // namespace touchstone::recording
