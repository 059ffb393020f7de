#include "harness/perception/judge/vibration_scale.h"

#include <algorithm>
#include <cmath>

#include "harness/perception/judge/procedure.h"

namespace touchstone::perception {
namespace {

constexpr double least_weber = 1e-9;  // below it asinh(w E) / w is E in every digit

double above_nothing(double power, double weber) { return std::asinh(weber * power) / weber; }

}  // namespace

double vibration_criterion_d_prime() { return d_prime_of_forced_choice(three_down_one_up); }

VibrationScale::VibrationScale(const Thresholds& thresholds) {
  const double before = std::pow(10.0, vibration_level_dB / 10.0);
  const double after = before * std::pow(1.0 + thresholds.vibration_fraction, 2);
  const double wanted = vibration_criterion_d_prime();
  // The larger w, the less is felt. Without any (w = 0) the constant noise alone is left.
  double low = least_weber;
  double high = 1e3;
  constexpr int halvings = 200;
  for (int i = 0; i < halvings && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (above_nothing(after, middle) - above_nothing(before, middle) > wanted ? low : high) = middle;
  }
  weber_ = low;
  // Far above threshold two sines of the power E and the likeness r are sqrt(2 (1 - r)) E apart, with a noise of w E:
  // the published difference has d' = 1 where 1 - r = w^2 / 2.
  const double log_alike = std::log1p(-std::min(0.5 * weber_ * weber_, 1.0 - least_weber));
  tuning_octaves_ = std::log2(1.0 + thresholds.frequency_fraction) / std::sqrt(-log_alike);
}

double VibrationScale::likeness(double octaves) const { return std::exp(-std::pow(octaves / tuning_octaves_, 2)); }

double VibrationScale::from_nothing(double power) const { return above_nothing(power, weber_); }

double VibrationScale::noticed_from(double power) const {
  return std::sinh(weber_ + std::asinh(weber_ * power)) / weber_ - power;
}

double VibrationScale::noise_between(double power_1, double power_2) const {
  const double apart = power_2 - power_1;
  const double middle = 0.5 * (power_1 + power_2);
  // Where they hardly differ, the quotient loses its digits.
  if (!(std::abs(apart) > 1e-6 * (1.0 + std::abs(middle)))) return std::hypot(1.0, weber_ * middle);
  return apart / (from_nothing(power_2) - from_nothing(power_1));
}

}  // namespace touchstone::perception
