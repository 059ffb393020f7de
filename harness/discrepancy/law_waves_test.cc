#include "harness/discrepancy/law_waves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace touchstone::discrepancy {
namespace {

// Means over blocks of 1/30 s of a tone along z, at rest.
LeftOver tone(std::size_t blocks, double frequency_Hz) {
  LeftOver left;
  for (std::size_t i = 0; i < blocks; ++i) {
    const double t_s = static_cast<double>(i) / 30.0;
    left.t_s.push_back(t_s);
    left.p_W_m.push_back(Vec3::Zero());
    left.f_W_N.emplace_back(0.0, 0.0, std::sin(2.0 * std::numbers::pi * frequency_Hz * t_s + 0.3));
  }
  return left;
}

TEST(WavePeaks, NameALineByItsFrequency) {
  const WavePeaks peaks = wave_peaks(tone(600, 4.2));
  ASSERT_FALSE(peaks.frequency_Hz.empty());
  EXPECT_NEAR(peaks.frequency_Hz.front(), 4.2, 0.01);
}

// A line below Nyquist has an image as strong above it.
TEST(WavePeaks, AreNotBeyondNyquist) {
  for (std::size_t blocks = 100; blocks < 140; ++blocks) {
    const double duration_s = static_cast<double>(blocks - 1) / 30.0;
    for (const double peak_Hz : wave_peaks(tone(blocks, 15.0 - 1.0 / duration_s)).frequency_Hz) {
      EXPECT_LE(peak_Hz, 15.0 + 1e-9) << blocks;
    }
  }
}

TEST(WavePeaks, NameAWaveOverPlaceByItsVector) {
  const Vec3 wave_per_m(31.0, -17.0, 24.0);
  LeftOver left;
  for (int i = 0; i < 900; ++i) {
    const double t = static_cast<double>(i) / 30.0;
    left.t_s.push_back(t);
    left.p_W_m.emplace_back(0.05 * std::sin(1.1 * t), 0.04 * std::cos(1.7 * t + 0.4), 0.03 * std::sin(2.9 * t + 1.0));
    left.f_W_N.emplace_back(0.0, 0.2, std::sin(2.0 * std::numbers::pi * wave_per_m.dot(left.p_W_m.back()) + 0.3));
  }
  const WavePeaks peaks = wave_peaks(left);
  ASSERT_FALSE(peaks.wave_per_m.empty());
  const Vec3 found = peaks.wave_per_m.front();
  // A quarter of a turn over the extent.
  EXPECT_LT(std::min((found - wave_per_m).norm(), (found + wave_per_m).norm()), 0.25 / 0.06) << found.transpose();
}

}  // namespace
}  // namespace touchstone::discrepancy
