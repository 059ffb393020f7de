#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/perception/features/change_rate.h"
#include "harness/perception/features/rate_hardness.h"
#include "harness/perception/features/spectrum.h"
#include "harness/perception/haptic_image.h"

namespace touchstone::perception {
namespace {

TEST(ChangeRate, SlopesBetweenKeptSamples) {
  SparseSeries series;
  series.held = {0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 3.0, 3.0};
  series.kept = {0, 2, 6};
  // (1 - 0) / 2 samples, (3 - 1) / 4 samples, nothing after the last; at 10 Hz.
  EXPECT_EQ(change_rate(series, 10.0), (std::vector<double>{5, 5, 5, 5, 5, 5, 0, 0}));
}

TEST(ChangeRate, IntegratesBackToWhatIsFelt) {
  Random random(8);
  std::vector<double> x;
  for (int n = 0; n < 2000; ++n) x.push_back(3.0 + 3.0 * std::sin(0.01 * n) + 0.01 * random.normal());
  const auto felt = dead_band(x, fingertip_force);
  const auto rate = change_rate(felt, 1000.0);
  double integral = felt.held.front();
  for (std::size_t t = 0; t < felt.kept.back(); ++t) integral += rate[t] / 1000.0;
  EXPECT_NEAR(integral, felt.held.back(), 1e-10);
}

struct Press {
  std::vector<double> force_N;
  std::vector<double> displacement_m;
};

Press spring_press(double k, double exponent, double stroke_m, std::size_t samples) {
  Press press;
  for (std::size_t n = 0; n < samples; ++n) {
    const double s = 0.5 * stroke_m *
                     (1.0 - std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(samples)));
    press.displacement_m.push_back(s);
    press.force_N.push_back(k * std::pow(s, exponent));
  }
  return press;
}

TEST(RateHardness, IsTheStiffnessOfALinearSpringAtEveryScaleAndWindow) {
  for (const double k : {1e-3, 500.0, 1e6}) {
    for (const double stroke : {1e-6, 0.01, 10.0}) {
      const Press press = spring_press(k, 1.0, stroke, 1000);
      for (const std::size_t window : {5u, 10u, 20u, 40u}) {
        const auto h = rate_hardness(press.force_N, press.displacement_m, window);
        ASSERT_EQ(h.values_N_per_m.size(), 1000 - window);
        for (const double value : h.values_N_per_m) EXPECT_NEAR(value, k, 1e-9 * k);
      }
    }
  }
}

TEST(RateHardness, OfAQuadraticSpringIsTheSecant) {
  const Press press = spring_press(4e4, 2.0, 0.01, 1000);
  const auto h = rate_hardness(press.force_N, press.displacement_m, 10);
  for (std::size_t n = 0; n < h.values_N_per_m.size(); ++n) {
    if (h.guarded[n]) continue;
    EXPECT_NEAR(h.values_N_per_m[n], 4e4 * (press.displacement_m[n] + press.displacement_m[n + 10]), 1e-6 * 800.0);
  }
}

TEST(RateHardness, TheGuardHoldsWhereTheMotionTurnsAndSaysHowOften) {
  const Press press = spring_press(500.0, 1.0, 0.01, 1000);
  auto noisy = press;
  Random random(2);
  for (double& f : noisy.force_N) f += 0.001 * random.normal();
  const auto h = rate_hardness(noisy.force_N, noisy.displacement_m, 10);
  EXPECT_GT(h.guarded_share, 0.01);
  EXPECT_LT(h.guarded_share, 0.2);
  // Unguarded, the turning points divide noise by almost nothing.
  const auto bare = rate_hardness(noisy.force_N, noisy.displacement_m, 10, 0.0);
  const auto worst = [](const RateHardness& hardness) {
    double result = 0.0;
    for (const double value : hardness.values_N_per_m) result = std::max(result, std::abs(value - 500.0));
    return result;
  };
  EXPECT_GT(worst(bare), 3.0 * worst(h));
}

TEST(RateHardness, NoMotionGivesNoHardnessAndBadInputIsSaid) {
  const std::vector<double> still(50, 0.01);
  const std::vector<double> force(50, 1.0);
  const auto h = rate_hardness(force, still, 10);
  EXPECT_EQ(h.guarded_share, 1.0);
  EXPECT_EQ(h.values_N_per_m, std::vector<double>(40, 0.0));
  EXPECT_THROW(rate_hardness(force, still, 50), BadData);
  EXPECT_THROW(rate_hardness(force, still, 0), UsageError);
  EXPECT_THROW(rate_hardness(force, std::vector<double>(49, 0.0), 10), BadData);
}

TEST(WindowTradeOff, ALargerWindowIsQuieterAndCoarser) {
  Press press = spring_press(500.0, 1.0, 0.01, 4000);
  Random random(3);
  for (double& f : press.force_N) f += 0.01 * random.normal();
  const std::vector<std::size_t> windows{5, 10, 20, 40};
  const auto trade = window_trade_off(press.force_N, press.displacement_m, 1000.0, windows);
  ASSERT_EQ(trade.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ(trade[i].duration_s, static_cast<double>(windows[i]) / 1000.0);
    EXPECT_NEAR(trade[i].level_N_per_m, 500.0, 0.1 * 500.0);
    if (i == 0) continue;
    EXPECT_LT(trade[i].noise_N_per_m, 0.7 * trade[i - 1].noise_N_per_m);  // halves with the window for white noise
    EXPECT_GT(trade[i].resolution_m, 1.8 * trade[i - 1].resolution_m);
  }
}

TEST(ExtendedRateHardness, OfASpringTappedAtConstantSpeedIsItsStiffness) {
  std::vector<double> force;
  std::vector<double> rate;
  std::vector<double> velocity;
  for (int n = 0; n < 100; ++n) {
    velocity.push_back(0.1);
    force.push_back(n < 20 ? 0.0 : 700.0 * 0.1 * 0.001 * (n - 20));
    rate.push_back(n < 20 ? 0.0 : 70.0);
  }
  EXPECT_NEAR(extended_rate_hardness(force, rate, velocity, 0.06).value(), 700.0, 1e-9);
  EXPECT_EQ(extended_rate_hardness(std::vector<double>(100, 0.0), rate, velocity, 0.06), std::nullopt);
  std::vector<double> stopped(100, 0.0);
  EXPECT_EQ(extended_rate_hardness(force, rate, stopped, 0.06), std::nullopt);  // no approach to divide by
}

TEST(Spectrum, AmplitudesOfSinesAtAnyScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    std::vector<double> x;
    for (int n = 0; n < 8000; ++n) {
      const double t = n / 1000.0;
      x.push_back(scale * (5.0 + 2.0 * std::sin(2.0 * std::numbers::pi * 1.0 * t) +
                           0.5 * std::cos(2.0 * std::numbers::pi * 3.0 * t)));
    }
    const auto spectrum = amplitude_spectrum(x, 1000.0, 25.0);
    EXPECT_DOUBLE_EQ(spectrum.step_Hz, 0.125);
    ASSERT_EQ(spectrum.amplitude.size(), 201u);
    EXPECT_NEAR(spectrum.amplitude[8], 2.0 * scale, 1e-9 * scale);
    EXPECT_NEAR(spectrum.amplitude[24], 0.5 * scale, 1e-9 * scale);
    EXPECT_NEAR(spectrum.amplitude[16], 0.0, 1e-9 * scale);
    EXPECT_NEAR(harmonic_share(spectrum), 0.25, 1e-9);
  }
  EXPECT_EQ(harmonic_share(amplitude_spectrum(std::vector<double>(100, 3.0), 100.0, 25.0)), 0.0);
}

// A peak that leaks to one side only: its energy is that of three values, of a harmonic, too.
TEST(Spectrum, TheEnergyOfAPeakIsThatOfBothNeighbours) {
  EXPECT_NEAR(harmonic_share({1.0, {0, 0, 0.6, 1.0, 0, 0.3, 0.4, 0}}), 0.5 / std::sqrt(1.36), 1e-12);
  EXPECT_NEAR(harmonic_share({1.0, {0, 0, 0, 1.0, 0.6, 0, 0.4, 0.3}}), 0.5 / std::sqrt(1.36), 1e-12);
}

// Taps on springs: median 600 N/m, and by hand a spread of 100 N/m about it, of 2 degrees of freedom (4.3027).
TEST(ExtendedRateHardness, TheIntervalIsStudentsForTheSpreadAboutTheMedian) {
  std::vector<double> force;
  std::vector<double> displacement;
  for (const double k : {500.0, 700.0, 600.0}) {
    for (int i = -50; i < 50; ++i) {
      displacement.push_back(1e-4 * i);
      force.push_back(i > 0 ? k * displacement.back() : 0.0);
    }
  }
  const auto h = estimated_rate_hardness(force, displacement, 1000.0, 1e-3);
  EXPECT_EQ(h, std::nullopt) << "wider than the value";
  // The same taps twice over: 5 degrees of freedom (2.5706), a variance of 4e4 / 5.
  std::vector<double> forces = force;
  std::vector<double> displacements = displacement;
  forces.insert(forces.end(), force.begin(), force.end());
  displacements.insert(displacements.end(), displacement.begin(), displacement.end());
  const auto twice = estimated_rate_hardness(forces, displacements, 1000.0, 1e-3).value();
  EXPECT_EQ(twice.contacts, 6U);
  EXPECT_NEAR(twice.value_N_per_m, 600.0, 1e-6);
  const double reach = 2.570582 * 1.2533 * std::sqrt(4e4 / 5.0 / 6.0);
  EXPECT_NEAR(twice.low95_N_per_m, 600.0 - reach, 1e-3);
  EXPECT_NEAR(twice.high95_N_per_m, 600.0 + reach, 1e-3);
}

TEST(Averaged, MeansOfEqualPartsAndInterpolation) {
  EXPECT_THAT(averaged(std::vector<double>{1, 3, 5, 7}, 2), ::testing::ElementsAre(2, 6));
  EXPECT_THAT(averaged(std::vector<double>{1, 3}, 3), ::testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(averaged(std::vector<double>{1, 2, 3, 4, 5}, 2), ::testing::ElementsAre(1.5, 4));
}

}  // namespace
}  // namespace touchstone::perception
