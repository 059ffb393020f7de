// The same texture is called the same whatever the noise, another one is not, and too little is not called either.
#include "texture_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "made_texture_for_test.h"
#include "texture_bands.h"

namespace touchstone::texture {
namespace {

using ::testing::HasSubstr;

constexpr double tolerance_dB = 3.0;
const perception::Thresholds thresholds;

SlideWindows slide(double frequency_Hz, double variance, double seconds, std::uint64_t seed, double rate_Hz = 1000.0) {
  const auto filter = std::pair{resonance(frequency_Hz, 0.9, rate_Hz), variance};
  return slide_windows(made_slide({{0.08, 0.8, seconds}, {0.16, 0.8, seconds}}, {filter, filter}, 0.3, rate_Hz, seed),
                       Vec3::UnitZ(), 0.5);
}

// One filter at every speed and force.
TextureModel one_filter(double frequency_Hz, double variance, double rate_Hz = 1000.0) {
  TextureModel model = made_texture(rate_Hz);
  for (TextureNode& node : model.nodes) {
    node.ar_rad = line_spectral_frequencies(resonance(frequency_Hz, 0.9, rate_Hz));
    node.variance = variance;
  }
  return model;
}

TextureComparison compare(const SlideWindows& expected, const SlideWindows& recorded) {
  return compare_textures(recorded_bands(expected, thresholds), recorded_bands(recorded, thresholds), tolerance_dB,
                          thresholds);
}
TextureComparison compare(const TextureModel& expected, const SlideWindows& recorded) {
  return compare_textures(expected_bands(expected, made_mass_kg, recorded, thresholds),
                          recorded_bands(recorded, thresholds), tolerance_dB, thresholds);
}

// What a window shows of a model on average is exact: the mean of many windows comes to it, also where a narrow
// resonance shows through the window's own side lobes alone.
TEST(TextureBands, TheExpectedPowerIsTheMeanOfManyWindows) {
  for (const auto& [rate_Hz, radius] : {std::pair{600.0, 0.9}, {1000.0, 0.9}, {2000.0, 0.9}, {1000.0, 0.998}}) {
    const auto filter = std::pair{resonance(110.0, radius, rate_Hz), 0.1};
    const SlideWindows windows =
        slide_windows(made_slide({{0.08, 0.8, 400.0}}, {filter}, 0.3, rate_Hz, 7), Vec3::UnitZ(), 0.5);
    TextureModel model = one_filter(110.0, 0.1, rate_Hz);
    for (TextureNode& node : model.nodes) node.ar_rad = line_spectral_frequencies(filter.first);
    const auto recorded = recorded_bands(windows, thresholds);
    const auto expected = expected_bands(model, made_mass_kg, windows, thresholds);
    for (std::size_t b = 0; b < perception::band_centres_Hz().size(); ++b) {
      if (perception::band_centres_Hz()[b] > 0.4 * rate_Hz) continue;
      EXPECT_NEAR(recorded.contact.power_N2[b], expected.contact.power_N2[b],
                  4.5 * std::sqrt(recorded.contact.variance_N4[b]))
          << rate_Hz << " Hz, radius " << radius << ", band " << perception::band_centres_Hz()[b];
    }
  }
}

TEST(TextureComparison, TheSameIsTheSameAndNeverDifferent) {
  int same = 0;
  constexpr int pairs = 60;
  for (int seed = 0; seed < pairs; ++seed) {
    const SlideWindows recorded = slide(110.0, 0.1, 10.0, 100 + static_cast<std::uint64_t>(seed));
    const TextureComparison with_model = compare(one_filter(110.0, 0.1), recorded);
    const TextureComparison with_other =
        compare(slide(110.0, 0.1, 10.0, 900 + static_cast<std::uint64_t>(seed)), recorded);
    EXPECT_NE(with_model.verdict, TextureVerdict::different) << with_model.reason;
    EXPECT_NE(with_other.verdict, TextureVerdict::different) << with_other.reason;
    same += with_model.verdict == TextureVerdict::same ? 1 : 0;
    same += with_other.verdict == TextureVerdict::same ? 1 : 0;
  }
  EXPECT_GE(same, 2 * pairs - 6);
}

TEST(TextureComparison, AnotherStrengthOrFrequencyIsDifferent) {
  const SlideWindows recorded = slide(110.0, 0.1, 10.0, 1);
  for (const auto& [frequency_Hz, variance] :
       {std::pair{110.0, 0.4}, {110.0, 0.025}, {190.0, 0.1}, {60.0, 0.1}, {110.0, 0.0}}) {
    EXPECT_EQ(compare(one_filter(frequency_Hz, variance), recorded).verdict, TextureVerdict::different)
        << frequency_Hz << " Hz, " << variance;
    if (variance > 0.0) {
      EXPECT_EQ(compare(slide(frequency_Hz, variance, 10.0, 2), recorded).verdict, TextureVerdict::different)
          << frequency_Hz << " Hz, " << variance;
    }
  }
}

// A recording at one speed against one at two whose textures differ: only what slid alike counts.
TEST(TextureComparison, OtherSpeedsDoNotCount) {
  const std::pair slow{resonance(60.0, 0.9, 1000.0), 0.1}, fast{resonance(190.0, 0.9, 1000.0), 0.3};
  const SlideWindows both = slide_windows(
      made_slide({{0.06, 0.8, 10.0}, {0.16, 0.8, 10.0}}, {slow, fast}, 0.3, 1000.0, 1), Vec3::UnitZ(), 0.5);
  const SlideWindows one = slide_windows(made_slide({{0.16, 0.8, 10.0}}, {fast}, 0.3, 1000.0, 2), Vec3::UnitZ(), 0.5);
  const TextureComparison comparison = compare(both, one);
  EXPECT_EQ(comparison.verdict, TextureVerdict::same) << comparison.reason;
  EXPECT_EQ(compare(one, both).verdict, TextureVerdict::same);
  EXPECT_LT(compare(one, both).windows, both.windows.size());
}

TEST(TextureComparison, WhatNobodyFeelsIsNotJudged) {
  const SlideWindows faint = slide(110.0, 1e-7, 10.0, 1);
  EXPECT_EQ(compare(one_filter(110.0, 4e-7), faint).verdict, TextureVerdict::same);
}

TEST(TextureComparison, TooLittleIsNotTold) {
  const TextureComparison brief = compare(one_filter(110.0, 0.1), slide(110.0, 0.1, 0.5, 3));
  EXPECT_EQ(brief.verdict, TextureVerdict::cannot_tell);
  EXPECT_THAT(brief.reason, HasSubstr("8 are needed"));
  const SlideWindows slow = slide_windows(
      made_slide({{0.02, 0.8, 10.0}}, {{resonance(110.0, 0.9, 1000.0), 0.1}}, 0.3, 1000.0, 3), Vec3::UnitZ(), 0.5);
  EXPECT_THAT(compare(slow, slide(110.0, 0.1, 10.0, 3)).reason, HasSubstr("like speed and force in 0 of"));
  const TextureComparison wide = compare(one_filter(110.0, 0.1), slide(110.0, 0.1, 1.0, 3));
  EXPECT_EQ(wide.verdict, TextureVerdict::cannot_tell) << wide.reason;
  EXPECT_THAT(wide.reason, HasSubstr("longer recording"));
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TextureComparison one = compare(one_filter(110.0, 0.1), slide(110.0, 0.1, 0.8, 50 + seed));
    EXPECT_NE(one.verdict, TextureVerdict::different) << seed << ": " << one.reason;
  }
}

TEST(TextureComparison, TheJsonHasEveryBand) {
  const TextureComparison comparison = compare(one_filter(110.0, 0.1), slide(110.0, 0.1, 10.0, 5));
  const auto json = nlohmann::json::parse(json_of(comparison, "a.xml", "b.csv"));
  EXPECT_EQ(json["schema"], "touchstone-texture-comparison/1");
  EXPECT_EQ(json["verdict"], "same");
  ASSERT_EQ(json["bands"].size(), comparison.bands.size());
  EXPECT_GT(comparison.bands.size(), 12U);
  for (const auto& band : json["bands"]) EXPECT_TRUE(band["difference_dB"].is_number());
}

}  // namespace
}  // namespace touchstone::texture
