// What is played has the model's spectrum: the exact formula against a long play, at several speeds, forces and rates.
#include "texture_signal.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "harness/perception/fourier.h"
#include "harness/testing/allocation_guard.h"
#include "made_texture_for_test.h"

namespace touchstone::texture {
namespace {

// Mean power between two frequencies over segments of a second, without a window: the formula is smooth over one hertz.
struct BandMean {
  double power = 0.0;
  double expected = 0.0;
  double error = 0.0;  // standard error, of Gaussian noise: mean over the root of the number of bins
};

BandMean band_mean(const std::vector<double>& x, double rate_Hz, const TextureFilter& filter, double model_rate_Hz,
                   double low_Hz, double high_Hz) {
  const auto length = static_cast<std::size_t>(rate_Hz);
  BandMean mean;
  double bins = 0.0;
  for (std::size_t first = 0; first + length <= x.size(); first += length) {
    std::vector<double> segment(length);
    for (std::size_t i = 0; i < length; ++i) {
      const double turn = static_cast<double>(i) / static_cast<double>(length);
      segment[i] = x[first + i] * std::sqrt(2.0 / 3.0) * (1.0 - std::cos(2.0 * std::numbers::pi * turn));
    }
    const auto spectrum = perception::real_fourier(segment);
    for (auto f = static_cast<std::size_t>(low_Hz); f < static_cast<std::size_t>(high_Hz); ++f) {
      mean.power += 2.0 * std::norm(spectrum[f]) / (static_cast<double>(length) * rate_Hz);
      bins += 1.0;
    }
  }
  mean.power /= bins;
  const double width = high_Hz - low_Hz;
  for (double f = low_Hz; f < high_Hz; f += 1.0) mean.expected += filter.density(f, model_rate_Hz) / width;
  mean.error = mean.expected * std::sqrt(1.94 / bins);  // of a Hann window the bins are not independent
  return mean;
}

struct Played {
  const char* name;
  double speed_m_per_s, force_N, rate_Hz, model_rate_Hz;
  bool numerator;
};

class TextureSpectrum : public ::testing::TestWithParam<Played> {};

TEST_P(TextureSpectrum, IsThatOfTheFormula) {
  const Played& played = GetParam();
  TextureModel made = made_texture(played.model_rate_Hz);
  if (played.numerator) {
    for (TextureNode& node : made.nodes) {
      node.ma_rad = {0.9, 1.6, 2.4};
      node.gain = 1.7 + node.force_N;
    }
  }
  const auto model = std::make_shared<const TextureModel>(made);
  TexturePlayer player(model, 41);
  std::vector<double> x;
  const auto samples = static_cast<int>(240.0 * played.rate_Hz);
  for (int i = -2000; i < samples; ++i) {
    const double value = player.at(10.0 + i / played.rate_Hz, played.speed_m_per_s, played.force_N);
    if (i >= 0) x.push_back(value);
  }
  const TextureFilter filter = filter_at(*model, played.speed_m_per_s, played.force_N);
  const double highest_Hz = 0.4 * std::min(played.rate_Hz, played.model_rate_Hz);
  for (double low = 20.0; low * 1.26 < highest_Hz; low *= 1.26) {
    const BandMean mean =
        band_mean(x, played.rate_Hz, filter, played.model_rate_Hz, std::floor(low), std::floor(low * 1.26));
    EXPECT_NEAR(mean.power, mean.expected, 4.5 * mean.error) << low << " Hz";
  }
  if (played.rate_Hz > 1.25 * played.model_rate_Hz) {
    const BandMean image =
        band_mean(x, played.rate_Hz, filter, played.model_rate_Hz, 0.61 * played.model_rate_Hz, 0.5 * played.rate_Hz);
    EXPECT_LT(image.power, 1e-5 * filter.density(100.0, played.model_rate_Hz)) << "no images above the model's band";
  }
}

INSTANTIATE_TEST_SUITE_P(SpeedsForcesRates, TextureSpectrum,
                         ::testing::Values(Played{"at_a_node", 0.1, 1.0, 1000.0, 1000.0, false},
                                           Played{"slow_and_light", 0.04, 0.6, 1000.0, 1000.0, false},
                                           Played{"fast_and_hard", 0.19, 1.9, 1000.0, 1000.0, false},
                                           Played{"with_a_numerator", 0.15, 1.2, 1000.0, 1000.0, true},
                                           Played{"at_2_kHz", 0.15, 1.2, 2000.0, 2000.0, true},
                                           Played{"in_a_faster_loop", 0.1, 1.0, 3000.0, 1000.0, false},
                                           Played{"in_a_slower_loop", 0.1, 1.0, 700.0, 1000.0, false},
                                           Played{"model_at_1300_Hz", 0.1, 1.0, 1000.0, 1300.0, false}),
                         [](const auto& test) { return std::string(test.param.name); });

// What lies above half the loop's rate must not come down into its band: 420 Hz would be heard at 280 Hz.
TEST(TexturePlayer, ASlowerLoopFoldsNothingDown) {
  TextureModel made = made_texture();
  for (TextureNode& node : made.nodes) {
    node.ar_rad = line_spectral_frequencies(resonance(420.0, 0.93, 1000.0));
    node.variance = 0.1;
  }
  TexturePlayer player(std::make_shared<const TextureModel>(made), 8);
  std::vector<double> x;
  for (int i = 0; i < 700 * 120; ++i) x.push_back(player.at(i / 700.0, 0.1, 1.0));
  const TextureFilter filter = filter_at(made, 0.1, 1.0);
  const BandMean mean = band_mean(x, 700.0, filter, 1000.0, 250.0, 280.0);
  EXPECT_NEAR(mean.power, mean.expected, 4.5 * mean.error + 0.05 * mean.expected);
}

TEST(TexturePlayer, ALoopAtTheModelsRateGetsTheSamplesThemselvesLate) {
  const auto model = std::make_shared<const TextureModel>(made_texture());
  TextureSignal signal(model, 3);
  TexturePlayer player(model, 3);
  std::vector<double> samples;
  for (int i = 0; i < 5000; ++i) {
    samples.push_back(signal.next(0.1, 1.0));
    const double played = player.at(2.5 + 0.001 * i, 0.1, 1.0);
    if (i < static_cast<int>(TexturePlayer::half_width)) continue;
    ASSERT_NEAR(played, samples[static_cast<std::size_t>(i) - TexturePlayer::half_width], 1e-12);
  }
}

TEST(TexturePlayer, ResetAndSeedDecideEverySample) {
  const auto model = std::make_shared<const TextureModel>(made_texture());
  TexturePlayer one(model, 3), other(model, 4);
  std::vector<double> first;
  int differ = 0;
  for (int i = 0; i < 500; ++i) {
    first.push_back(one.at(0.0013 * i, 0.1, 1.0));
    differ += first.back() != other.at(0.0013 * i, 0.1, 1.0) ? 1 : 0;
  }
  EXPECT_GT(differ, 480);
  one.reset();
  for (int i = 0; i < 500; ++i) ASSERT_EQ(one.at(0.0013 * i, 0.1, 1.0), first[static_cast<std::size_t>(i)]);
}

TEST(TexturePlayer, AllocatesNothingAndSurvivesAPause) {
  const auto model = std::make_shared<const TextureModel>(made_texture());
  TexturePlayer player(model, 3);
  double sum = 0.0;
  const testing::AllocationGuard guard;
  for (int i = 0; i < 1000; ++i) sum += std::abs(player.at(0.001 * i, 0.1, 1.0));
  sum += std::abs(player.at(1e7, 0.1, 1.0));
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(TexturePlayer, SlidingThatStopsDiesAway) {
  const auto model = std::make_shared<const TextureModel>(made_texture());
  TexturePlayer player(model, 3);
  for (int i = 0; i < 1000; ++i) player.at(0.001 * i, 0.1, 1.0);
  double last = 1.0;
  for (int i = 1000; i < 2000; ++i) last = player.at(0.001 * i, 0.0, 0.0);
  EXPECT_LT(std::abs(last), 1e-20);
}

}  // namespace
}  // namespace touchstone::texture
