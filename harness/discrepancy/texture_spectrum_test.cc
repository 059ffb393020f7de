// A wave of the surface under a spring, and under what presses or gives way beside the depth.
#include "harness/discrepancy/texture_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/discrepancy/plane_for_test.h"

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::Prediction;

namespace {

constexpr double stiffness_N_per_m = 900.0;
constexpr double wavelength_m = 0.007;
constexpr double direction_rad = 0.6;
constexpr double amplitude_m = 2e-4;

Prediction on_plane(const MotionColumns& motion, double unit) {
  rendering::Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = stiffness_N_per_m / unit;
  return PlanePredictor(motion).predict(model);
}

// A plane with the wave, over which the tip presses.
Recording over_wave(double unit) {
  Recording recording;
  recording.motion = hand(0.3, unit);
  const Prediction plane = on_plane(recording.motion, unit);
  const Vec3 along(std::cos(direction_rad), std::sin(direction_rad), 0.0);
  for (std::size_t i = 0; i < recording.motion.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * along.dot(recording.motion.p_W_m[i]) / (wavelength_m * unit);
    const bool touches = !plane.n_W[i].isZero();
    const double wave_N = touches ? stiffness_N_per_m * amplitude_m * std::sin(turn) : 0.0;
    recording.f_W_N.emplace_back(plane.f_W_N[i] + wave_N * Vec3::UnitZ());
  }
  return recording;
}

void expect_wave(const std::vector<TexturePeak>& peaks, double unit) {
  ASSERT_EQ(peaks.size(), 4U);
  // The scan is 50 mm wide: a third of a wave more or fewer over it is the next of the grid.
  EXPECT_NEAR(1.0 / peaks.front().wavelength_m, 1.0 / (wavelength_m * unit), 0.5 / (0.05 * unit));
  EXPECT_NEAR(peaks.front().direction_rad, direction_rad, 0.1);
  EXPECT_NEAR(peaks.front().amplitude_m, amplitude_m * unit, 0.35 * amplitude_m * unit);
  EXPECT_GT(peaks.front().power, 0.5);
}

TEST(TextureSpectrum, FindsTheWaveUnderASpringAtEveryUnit) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    const Recording recording = over_wave(unit);
    expect_wave(texture_peaks(recording, on_plane(recording.motion, unit), 0.05 * unit, 4), unit);
  }
}

TEST(TextureSpectrum, FindsItWhereADamperPressesWithoutDepth) {
  const Recording recording = over_wave(1.0);
  Prediction damped = on_plane(recording.motion, 1.0);
  // Here and there a load where the depth is next to nothing, and next to nothing of it where it is deep.
  std::size_t touching = 0;
  for (std::size_t i = 0; i < damped.n_W.size(); ++i) {
    if (damped.n_W[i].isZero() || ++touching % 50 != 0) continue;
    (touching % 100 == 0 ? damped.depth_m : damped.normal_N)[i] = 1e-18;
  }
  ASSERT_GT(touching, 1000U);
  expect_wave(texture_peaks(recording, damped, 0.05, 4), 1.0);
}

}  // namespace
}  // namespace touchstone::discrepancy
