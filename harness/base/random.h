// Random numbers that are the same on every machine: the standard library's engines are, its distributions are not.
// Source: xoshiro256++ 1.0 (Blackman and Vigna, 2019), seeded by SplitMix64; normal deviates by Marsaglia's polar
// method.
#pragma once

#include <array>
#include <cstdint>

#include "harness/base/vec.h"

namespace touchstone {

class Random {
 public:
  explicit Random(std::uint64_t seed);

  std::uint64_t next_u64();
  // Uniform in [0, 1) with 53 random bits.
  double uniform();
  double uniform(double low, double high);
  // exp of a uniform in log: every decade of [low, high) is as likely, low > 0.
  double log_uniform(double low, double high);
  // Uniform integer in [0, n), n > 0, without modulo bias.
  std::uint64_t below(std::uint64_t n);
  // Standard normal.
  double normal();
  // Uniform on the unit sphere, and a uniform rotation.
  Vec3 direction();
  Quat rotation();
  // An independent stream for a part of the work, so that adding draws in one place does not change another.
  [[nodiscard]] Random stream(std::uint64_t index) const;

 private:
  std::uint64_t seed_;
  std::array<std::uint64_t, 4> state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace touchstone
