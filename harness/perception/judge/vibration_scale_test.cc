#include "harness/perception/judge/vibration_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "harness/perception/judge/procedure.h"
#include "harness/perception/judge/vibration.h"

namespace touchstone::perception {
namespace {

TEST(Procedure, GivesTheSharesAndDPrimesOfPublishedTables) {
  // Macmillan and Creelman (2005): d' = 1 is 76.0 % of two alternatives, 69.1 % of one interval without bias; Hacker
  // and Ratcliff (1979): d' = 1 is 63.4 % of three alternatives.
  EXPECT_NEAR(d_prime_of_forced_choice(0.7602), 1.0, 1e-3);
  EXPECT_NEAR(d_prime_of_one_interval(0.6915), 1.0, 1e-3);
  EXPECT_NEAR(d_prime_of_forced_choice(0.634, 3), 1.0, 5e-3);
  EXPECT_NEAR(d_prime_of_forced_choice(three_down_one_up), std::numbers::sqrt2 * 0.8193, 1e-3);
  EXPECT_EQ(d_prime_of_forced_choice(0.5), 0.0);
  // Two alternatives by the integral and by the closed form.
  EXPECT_NEAR(d_prime_of_forced_choice(0.9, 2), std::numbers::sqrt2 * 1.2815515655, 1e-9);
}

// Jones, Hunter and Lafontaine (1997) found 19 % of the viscosity at 71 % of two alternatives and 34 % at the 84 % of
// an adjustment, and took the results for consistent: at d' = 1 both are the same to a tenth.
TEST(Procedure, MakesTwoThresholdsOfOneQuantityAgree) {
  const auto at_unity = [](double fraction, double share) {
    return std::expm1(std::log1p(fraction) / d_prime_of_forced_choice(share));
  };
  EXPECT_NEAR(at_unity(0.19, two_down_one_up) / at_unity(0.34, 0.84), 1.0, 0.1);
}

TEST(Procedure, SimulatedObserversOfThreeAlternativesAreRightAsOftenAsItSays) {
  const double d = d_prime_of_forced_choice(two_down_one_up, 3);
  Random random(5);
  constexpr int trials = 40000;
  int right = 0;
  for (int t = 0; t < trials; ++t) {
    const double signal = d + random.normal();
    const double first = random.normal();
    right += signal > first && signal > random.normal() ? 1 : 0;
  }
  // Three standard errors of a share.
  EXPECT_NEAR(right / static_cast<double>(trials), two_down_one_up, 3.0 * 0.5 / std::sqrt(trials));
}

TEST(VibrationScale, HoldsBothPublishedFigures) {
  const VibrationScale scale{Thresholds{}};
  // Forta, Griffin and Morioka (2012): 20 % of the amplitude, 10 dB above threshold, at 79 %.
  EXPECT_NEAR(scale.from_nothing(10.0 * 1.2 * 1.2) - scale.from_nothing(10.0), std::numbers::sqrt2 * 0.8193, 1e-3);
  // The threshold of detection has d' = 1 but for the noise that goes with the power.
  EXPECT_NEAR(scale.from_nothing(1.0), 1.0, 0.02);
  // Near it d' grows with the power.
  EXPECT_NEAR(scale.from_nothing(0.01) / scale.from_nothing(0.0025), 4.0, 1e-3);
  // Far above it a constant share of the power is noticed.
  EXPECT_NEAR(scale.noticed_from(1e6) / 1e6, std::expm1(scale.weber()), 1e-6);
}

// Israr, Tan and Reed (2006): 25 % at 20 dB and 18 % at 35 dB above threshold; near threshold no frequency is told.
TEST(VibrationScale, AFrequencyIsToldByThePublishedFraction) {
  const VibrationScale scale{Thresholds{}};
  const auto told = [&scale](double fraction, double level_dB) {
    const double power = std::pow(10.0, level_dB / 10.0);
    const double apart = power * std::sqrt(2.0 * (1.0 - scale.likeness(std::log2(1.0 + fraction))));
    return apart / scale.noise_between(power, power);
  };
  EXPECT_NEAR(told(0.25, 20.0), 1.0, 0.2);
  EXPECT_NEAR(told(0.18, 35.0), 1.0, 0.2);
  EXPECT_LT(told(0.21, 0.0), 0.4);
  EXPECT_NEAR(told(-0.2, 30.0), told(0.25, 30.0), 1e-9);  // down as up: 1 / 1.25 = 0.8
}

TEST(VibrationScale, NoiseIsTheQuotientOfPowerAndDPrimeAtEveryDistance) {
  const VibrationScale scale{Thresholds{}};
  for (const double power : {0.0, 0.5, 10.0, 1e4}) {
    for (const double share : {1e-5, 1e-3, 0.3, 50.0}) {
      const double apart = share * (1.0 + power);  // less loses its digits in the difference of d'
      const double d = scale.from_nothing(power + apart) - scale.from_nothing(power);
      EXPECT_NEAR(scale.noise_between(power, power + apart) * d / apart, 1.0, 1e-5) << power << " " << share;
    }
    EXPECT_NEAR(scale.from_nothing(power + scale.noticed_from(power)) - scale.from_nothing(power), 1.0, 1e-9);
  }
}

TEST(VibrationScale, ASmallerFractionGivesAFinerScale) {
  Thresholds fine;
  fine.vibration_fraction = 0.1;
  Thresholds finest;
  finest.vibration_fraction = 0.01;  // finer than the constant noise allows: that alone is left
  EXPECT_LT(VibrationScale(fine).weber(), VibrationScale(Thresholds{}).weber());
  EXPECT_NEAR(VibrationScale(finest).from_nothing(5.0), 5.0, 1e-6);
}

}  // namespace
}  // namespace touchstone::perception
