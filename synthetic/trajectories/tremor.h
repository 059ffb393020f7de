// The tremor of a hand: band-limited, 8 to 12 Hz as physiological tremor of the hand is (Riviere, Rader and Khosla
// 1997), as a sum of sinusoids with seeded frequencies and phases, so that it is a function of time and independent of
// how it is sampled.
#pragma once

#include <cstdint>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::synthetic {

class Tremor {
 public:
  static constexpr double lowest_Hz = 8.0;
  static constexpr double highest_Hz = 12.0;

  // `rms` of every axis, in the unit of what trembles.
  Tremor(std::uint64_t seed, double rms);
  // The general one: any band.
  Tremor(std::uint64_t seed, double rms, double from_Hz, double to_Hz);

  [[nodiscard]] Vec3 at(double t_s) const noexcept;
  // The first axis alone.
  [[nodiscard]] double first_at(double t_s) const noexcept;

 private:
  struct Wave {
    double angular_rad_per_s;
    Vec3 phase_rad;
  };
  double amplitude_;
  std::vector<Wave> waves_;
};

}  // namespace touchstone::synthetic
