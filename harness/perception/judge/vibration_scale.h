// How strongly a vibration is felt, on a scale whose unit is d' = 1: an observer who measures the power of the
// vibration with an internal noise, constant near threshold and in proportion to the power above it (Green and Swets
// 1966, chapter 8: the energy detector with Weber's law).
//
// E is the power over that of the threshold. The noise's standard deviation is sqrt(1 + (w E)^2), so that the threshold
// itself has d' near 1, and d' grows with the square of the amplitude near it, as in negative masking: there a smaller
// change is noticed than the threshold of detection is. d' between E1 and E2 is (asinh(w E2) - asinh(w E1)) / w. The
// one constant w follows from a published difference threshold above a published level.
//
// The observer tells frequencies by how the power is spread over channels that overlap, as in models of hearing by
// excitation patterns (Florentine and Buus 1981). What a channel takes falls as a Gaussian over the logarithm of the
// frequency (the shape is ours), as wide as gives a published difference of the frequency d' = 1 far above threshold.
// There are no edges between channels, and near threshold no frequency is told.
#pragma once

#include "harness/perception/judge/thresholds.h"

namespace touchstone::perception {

// What `Thresholds::vibration_fraction` was measured at: a vibration 10 dB above threshold, a staircase of three down
// and one up (79 % of two-alternative choices right).
inline constexpr double vibration_level_dB = 10.0;
double vibration_criterion_d_prime();

class VibrationScale {
 public:
  explicit VibrationScale(const Thresholds& thresholds);

  // d' of the vibration of power E against none. Odd in E: noise may leave less than nothing.
  [[nodiscard]] double from_nothing(double power) const;
  // Standard deviation of the observer's measurement between the two powers: (E2 - E1) over d' between them.
  [[nodiscard]] double noise_between(double power_1, double power_2) const;
  // The added power that has d' = 1 above `power`.
  [[nodiscard]] double noticed_from(double power) const;
  // How much of a vibration the observer takes for one so many octaves away: 1 at none.
  [[nodiscard]] double likeness(double octaves) const;
  // Weber fraction of the power: the standard deviation over the power, far above threshold.
  [[nodiscard]] double weber() const noexcept { return weber_; }

 private:
  double weber_ = 0.0;
  double tuning_octaves_ = 0.0;
};

}  // namespace touchstone::perception
