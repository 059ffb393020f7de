#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/perception/distances/signal_distance.h"
#include "harness/perception/distances/structural_similarity.h"
#include "harness/perception/distances/vibration_similarity.h"

namespace touchstone::perception {
namespace {

TEST(SignalDistance, KnownValues) {
  const std::vector<double> a{1, 2, 3, 4};
  const std::vector<double> b{1, 0, 3, -5};
  EXPECT_DOUBLE_EQ(mean_square_error(a, b), 85.0 / 4.0);
  EXPECT_DOUBLE_EQ(euclidean_distance(a, b), std::sqrt(85.0));
  EXPECT_DOUBLE_EQ(maximum_absolute_error(a, b), 9.0);
  EXPECT_DOUBLE_EQ(peak_difference(a, b), 1.0);
  EXPECT_EQ(euclidean_distance(a, a), 0.0);
  EXPECT_THROW(euclidean_distance(a, std::vector<double>{1, 2, 3}), BadData);
  EXPECT_THROW(maximum_absolute_error({}, {}), BadData);
}

TEST(SignalDistance, CorrelationOfLinesIsOneAndOfConstantsNone) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    std::vector<double> x;
    std::vector<double> up;
    std::vector<double> down;
    for (int n = 0; n < 50; ++n) {
      x.push_back(scale * n * n);
      up.push_back(3.0 * x.back() + 7.0);
      down.push_back(-2.0 * x.back() + 1.0);
    }
    EXPECT_NEAR(pearson_correlation(x, up).value(), 1.0, 1e-12);
    EXPECT_NEAR(pearson_correlation(x, down).value(), -1.0, 1e-12);
    EXPECT_EQ(pearson_correlation(x, std::vector<double>(50, 0.1 * scale)), std::nullopt);
    EXPECT_EQ(pearson_correlation(std::vector<double>(50, 0.0), x), std::nullopt);
    // The mean of many equal values is not that value.
    const std::vector<double> still(60000, 1.2 * scale);
    std::vector<double> moving(60000);
    for (std::size_t n = 0; n < moving.size(); ++n) moving[n] = scale * std::sin(0.01 * static_cast<double>(n));
    EXPECT_EQ(pearson_correlation(still, moving), std::nullopt);
    EXPECT_EQ(pearson_correlation(moving, still), std::nullopt);
    // A change of a billionth is one.
    auto almost = still;
    for (std::size_t n = 0; n < almost.size(); ++n) almost[n] += 1e-9 * moving[n];
    EXPECT_NEAR(pearson_correlation(almost, moving).value(), 1.0, 1e-6);
  }
}

TEST(SignalDistance, PerceptualErrorCountsJustNoticeableDifferences) {
  const std::vector<double> real{1.0, 5.0};
  const std::vector<double> one_step{1.2, 5.35};  // 20 % of 1 N, 7 % of 5 N
  EXPECT_NEAR(perceptual_mean_square_error(real, one_step, fingertip_force), 1.0, 1e-12);
  // The same error in newtons matters less where the force is large.
  EXPECT_GT(perceptual_mean_square_error(std::vector<double>{0.5}, std::vector<double>{0.6}, fingertip_force),
            perceptual_mean_square_error(std::vector<double>{2.0}, std::vector<double>{2.1}, fingertip_force));
}

std::vector<double> wave(double amplitude, double offset, double noise, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> x;
  for (int n = 0; n < 2000; ++n) {
    x.push_back(offset + amplitude * std::sin(0.02 * n) + noise * random.normal());
  }
  return x;
}

TEST(StructuralSimilarity, IsOneForEqualSeriesSymmetricAndFallsWithNoise) {
  const auto real = wave(2.0, 3.0, 0.0, 1);
  EXPECT_DOUBLE_EQ(structural_similarity(real, real), 1.0);
  double last = 1.0;
  for (const double noise : {0.05, 0.2, 0.8, 3.2}) {
    const double now = structural_similarity(real, wave(2.0, 3.0, noise, 2));
    EXPECT_LT(now, last);
    last = now;
  }
  const auto other = wave(1.0, 2.5, 0.0, 1);
  EXPECT_LT(structural_similarity(real, other), 1.0);
}

TEST(StructuralSimilarity, DoesNotDependOnTheUnitAndFollowsItsFormula) {
  auto real = wave(2.0, 3.0, 0.1, 1);
  auto other = wave(1.5, 2.0, 0.1, 2);
  const double in_N = structural_similarity(real, other);
  for (auto* x : {&real, &other}) {
    for (double& value : *x) value *= 1e3;
  }
  EXPECT_NEAR(structural_similarity(real, other), in_N, 1e-12);
  // One window of two samples, written out: means 1 and 2, variances 1 and 4, covariance 2, range 2.
  StructuralSimilarityConstants constants;
  constants.window = 2;
  constants.stride = 1;
  const double c1 = std::pow(0.01 * 2.0, 2);
  const double c2 = std::pow(0.03 * 2.0, 2);
  const double expected =
      (2 * 1 * 2 + c1) / (1 + 4 + c1) * (2 * 1 * 2 + c2) / (1 + 4 + c2) * (2 + c2 / 2) / (2 + c2 / 2);
  EXPECT_NEAR(structural_similarity(std::vector<double>{0, 2}, std::vector<double>{0, 4}, constants), expected, 1e-12);
}

// With a covariance that is not the product of the deviations, C3 shows: five samples, written out.
TEST(StructuralSimilarity, TheThirdConstantIsHalfTheSecond) {
  StructuralSimilarityConstants constants;
  constants.window = 5;
  constants.stride = 1;
  constants.alpha = constants.beta = 0.0;
  // Both have the mean 2 and the variance 2; the range is 4.
  const std::vector<double> real{0, 1, 2, 3, 4};
  const std::vector<double> rendered{1, 0, 2, 4, 3};
  const double covariance = (-2 * -1 + -1 * -2 + 0 * 0 + 1 * 2 + 2 * 1) / 5.0;
  const double c3 = 0.5 * std::pow(0.03 * 4.0, 2);
  EXPECT_NEAR(structural_similarity(real, rendered, constants), (covariance + c3) / (2.0 + c3), 1e-12);
}

TEST(StructuralSimilarity, ConstantsCounterPhaseAndShortSeries) {
  const std::vector<double> still(200, 2.0);
  EXPECT_EQ(structural_similarity(still, still), 1.0);
  EXPECT_LT(structural_similarity(still, std::vector<double>(200, 1.0)), 1.0);
  auto real = wave(2.0, 0.0, 0.0, 1);
  auto opposite = real;
  for (double& value : opposite) value = -value;
  // Means and slopes of opposite sign do not make up for each other.
  EXPECT_LE(structural_similarity(real, opposite), 0.0);
  StructuralSimilarityConstants root;
  root.r = 0.5;
  EXPECT_GE(structural_similarity(real, opposite, root), 0.0);
  EXPECT_THROW(structural_similarity(std::vector<double>(99, 1.0), std::vector<double>(99, 1.0)), BadData);
}

// Values that the reference implementation's own tests hold its threshold to: 22.253170255179413 dB in the last four of
// ten points at 2800 Hz, -15 dB everywhere at 0 Hz.
TEST(VibrationThreshold, AgreesWithTheReferenceImplementation) {
  const auto threshold = vibration_threshold_dB(2800.0, 10);
  for (std::size_t k = 6; k < 10; ++k) EXPECT_NEAR(threshold[k], 22.253170255179413, 1e-12);
  for (const double dB : vibration_threshold_dB(0.0, 10)) EXPECT_NEAR(dB, -15.0, 1e-12);
  const auto fine = vibration_threshold_dB(8000.0, 4096);
  const auto lowest = static_cast<std::size_t>(std::min_element(fine.begin(), fine.end()) - fine.begin());
  EXPECT_NEAR(static_cast<double>(lowest) * 8000.0 / 8191.0, 250.0, 1.0);  // Pacinian corpuscles are most sensitive
  EXPECT_NEAR(fine[lowest], -77.0, 0.01);
}

std::vector<double> vibration(double amplitude, double noise, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> x;
  for (int n = 0; n < 2048; ++n) {
    x.push_back(amplitude * std::sin(2.0 * std::numbers::pi * 200.0 * n / 8000.0) + noise * random.normal());
  }
  return x;
}

TEST(VibrationSimilarity, EqualIsOneAndNoiseLowersBoth) {
  const VibrationSettings settings;
  const auto real = vibration(1.0, 0.01, 1);
  EXPECT_EQ(spectral_temporal_similarity(real, real, settings), 1.0);
  EXPECT_EQ(spectral_perceptual_quality_index(real, real, settings), 1.0);
  double stsim = 1.0;
  double spqi = 1.0;
  for (const double noise : {0.02, 0.2, 2.0}) {
    const auto rendered = vibration(1.0, noise, 2);
    const double own_stsim = spectral_temporal_similarity(real, rendered, settings);
    const double own_spqi = spectral_perceptual_quality_index(real, rendered, settings);
    EXPECT_LT(own_stsim, stsim + 0.02);
    EXPECT_LT(own_spqi, spqi);
    stsim = own_stsim;
    spqi = own_spqi;
  }
  EXPECT_LT(stsim, 0.7);
  EXPECT_GE(stsim, 0.0);
  EXPECT_THROW(spectral_temporal_similarity(std::vector<double>(511, 1.0), std::vector<double>(511, 2.0), settings),
               BadData);
  EXPECT_THROW(spectral_perceptual_quality_index(real, std::vector<double>(2000, 1.0), settings), BadData);
}

// A louder copy has a spectral difference of |1 - g^2| in every block, and the same normalised blocks.
TEST(VibrationSimilarity, OfALouderCopyIsKnownInClosedForm) {
  const auto real = vibration(1.0, 0.1, 3);
  for (const double gain : {0.5, 0.99, 1.01, 1.5}) {
    auto louder = real;
    for (double& value : louder) value *= gain;
    const double dB = 10.0 * std::log10(std::abs(1.0 - gain * gain));
    EXPECT_NEAR(spectral_perceptual_quality_index(real, louder, {}), 0.5 * (1.0 - std::tanh(0.3 * dB + 2.0)), 1e-9);
  }
  // Only the temporal part counts as eta goes to one, and that does not see the gain.
  auto quieter = real;
  for (double& value : quieter) value *= 0.5;
  VibrationSettings temporal;
  temporal.stsim_eta = 1.0;
  EXPECT_NEAR(spectral_temporal_similarity(real, quieter, temporal), 1.0, 1e-9);
  EXPECT_LT(spectral_temporal_similarity(real, quieter, {}), 1.0);
}

// The reference implementation's own expectation: 0.85 to 0.1 for unit noise on a large constant with unit noise.
TEST(VibrationSimilarity, AgreesWithTheReferenceImplementationsExpectation) {
  Random random(3);
  std::vector<double> real(1000);
  std::vector<double> rendered(1000);
  for (std::size_t n = 0; n < 1000; ++n) {
    real[n] = 1000.0 + random.normal();
    rendered[n] = real[n] + random.normal();
  }
  EXPECT_NEAR(spectral_temporal_similarity(real, rendered, {}), 0.85, 0.1);
}

}  // namespace
}  // namespace touchstone::perception
