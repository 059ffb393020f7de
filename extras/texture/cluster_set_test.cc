// Files of the data set's layout, made from a known process: what a lab that has the set would fit.
#include "cluster_set.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <string>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/testing/temporary_folder.h"
#include "made_texture_for_test.h"
#include "texture_fit.h"

namespace touchstone::texture {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double fast_Hz = 18000.0;  // of the process, of which every second to fourth sample is in the file

class ClusterSet : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* const kind : {"accel", "force", "position"})
      std::filesystem::create_directories(folder_.path() / kind);
  }

  // 0.3 s at rest, 3 s at the speed, along 45 degrees. The process: a resonance, across which 1.25 kHz sound that must
  // not be folded into the model's band.
  void add(int texture, int speed_mm_per_s, int force_mN, double frequency_Hz, double deviation_g, std::uint64_t seed) {
    const std::string name = fmt::format("{}_45_{}_{}_0.csv", texture, speed_mm_per_s, force_mN);
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    std::uniform_int_distribution<int> stride(2, 4);
    const std::vector<double> a = resonance(frequency_Hz, radius, fast_Hz);
    std::string accel = "time,X,Y,Z\n", force = "time,force\n", position = "time,X,Y\n";
    double x1 = 0.0, x2 = 0.0;
    int next = 0;
    const auto samples = static_cast<int>(3.3 * fast_Hz);
    for (int i = 0; i < samples; ++i) {
      const double t = i / fast_Hz;
      const double x = deviation_g * normal(engine) - a[1] * x1 - a[2] * x2;
      x2 = x1;
      x1 = x;
      if (i == next) {
        accel += fmt::format("{:.12f},{:.6f},0.01,{:.6f}\n", t, x,
                             -1.0 + 0.05 * std::sin(2.0 * std::numbers::pi * 1250.0 * t));
        next += stride(engine);
      }
      if (i % 30 == 0) force += fmt::format("{:.9f},{:.4f}\n", t, force_mN / 1000.0);
      if (i % 180 == 0) {
        const double way_mm = std::max(0.0, t - 0.3) * speed_mm_per_s;
        position += fmt::format("{:.9f},{:.5f},{:.5f}\n", t, way_mm / std::sqrt(2.0), 45.0 - way_mm / std::sqrt(2.0));
      }
    }
    write_file(folder_.path() / "accel" / name, accel);
    write_file(folder_.path() / "force" / name, force);
    write_file(folder_.path() / "position" / name, position);
  }

  static constexpr double radius = 0.995;
  testing::TemporaryFolder folder_;
};

TEST_F(ClusterSet, TheProcessIsFoundInUnevenSamplesAndNothingIsFolded) {
  std::uint64_t seed = 1;
  for (const int force_mN : {500, 1000})
    for (const int speed : {20, 40, 60}) add(7, speed, force_mN, 100.0, 0.0004, seed++);
  add(8, 20, 500, 250.0, 0.004, seed);
  const SlideWindows windows = cluster_windows(folder_.path(), 7, made_mass_kg);
  // 3 s in each file are 11 whole windows, one of which begins at rest.
  EXPECT_GE(windows.windows.size(), 60U);
  EXPECT_LE(windows.windows.size(), 66U);
  for (const SlideWindow& window : windows.windows) {
    EXPECT_NEAR(window.speed_m_per_s, std::round(50.0 * window.speed_m_per_s) / 50.0, 0.0005);
    EXPECT_NEAR(window.load_N, std::round(2.0 * window.load_N) / 2.0, 1e-6);
  }
  const TextureFit fit = fit_texture(windows, made_mass_kg, "seven");
  TextureFilter truth;
  truth.ar_count = 2;
  const std::vector<double> a = resonance(100.0, radius, fast_Hz);
  std::copy(a.begin(), a.end(), truth.ar.begin());
  truth.ma[0] = 1.0;
  truth.variance = std::pow(0.0004 * 9.80665, 2);
  for (const double speed : {0.02, 0.04, 0.06}) {
    const TextureFilter found = filter_at(fit.model, speed, 0.9);
    // Ten seconds of it; above 350 Hz the filter that keeps 1.25 kHz out begins.
    for (double f = 40.0; f <= 350.0; f += 10.0)
      EXPECT_NEAR(10.0 * std::log10(found.density(f, 1000.0) / truth.density(f, fast_Hz)), 0.0, 2.0)
          << speed << " m/s, " << f << " Hz";
  }
}

TEST_F(ClusterSet, WhatIsMissingIsNamed) {
  EXPECT_THAT([&] { cluster_windows(folder_.path(), 7, made_mass_kg); },
              ThrowsMessage<BadData>(HasSubstr("accel/7_DIRECTION_SPEED_FORCE_REPEAT.csv (0 of other textures)")));
  add(7, 20, 500, 100.0, 0.0004, 1);
  std::filesystem::remove(folder_.path() / "force" / "7_45_20_500_0.csv");
  EXPECT_THAT([&] { cluster_windows(folder_.path(), 7, made_mass_kg); },
              ThrowsMessage<BadData>(HasSubstr("7_45_20_500_0.csv")));
  write_file(folder_.path() / "force" / "7_45_20_500_0.csv", "time,force\n0.1,0.5\n0.1,0.5\n");
  EXPECT_THAT([&] { cluster_windows(folder_.path(), 7, made_mass_kg); },
              ThrowsMessage<BadData>(HasSubstr("line 3: time does not advance")));
}

// Only what moves at the speed of its name counts.
TEST_F(ClusterSet, OtherSpeedsThanTheNamesAreLeftOut) {
  add(7, 20, 500, 100.0, 0.0004, 1);
  for (const char* const kind : {"accel", "force", "position"})
    std::filesystem::rename(folder_.path() / kind / "7_45_20_500_0.csv", folder_.path() / kind / "7_45_60_500_0.csv");
  EXPECT_THAT([&] { cluster_windows(folder_.path(), 7, made_mass_kg); },
              ThrowsMessage<BadData>(HasSubstr("nowhere slides")));
}

}  // namespace
}  // namespace touchstone::texture
