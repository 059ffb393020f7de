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

}  // namespace
}  // namespace touchstone::discrepancy
