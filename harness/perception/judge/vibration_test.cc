#include "harness/perception/judge/vibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "harness/perception/judge/judge.h"

namespace touchstone::perception {
namespace {

// Presses on a spring, once from the air, seen by a noisy tracker and a quiet force sensor.
Recording presses(double k_N_per_m, double position_noise_m, std::uint64_t seed) {
  Random random(seed);
  Recording recording;
  recording.source = "presses";
  for (int i = 0; i < 20000; ++i) {
    const double t = 0.001 * i;
    const double depth = -0.0005 + 0.0025 * (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * t));
    recording.motion.t_s.push_back(t);
    recording.motion.p_W_m.emplace_back(0.02 * t, 0.0, -depth + position_noise_m * random.normal());
    recording.f_W_N.emplace_back(0.0, 0.0, depth > 0.0 ? k_N_per_m * depth : 0.0);
  }
  return recording;
}

// 10 um of tracker noise times 2000 N/m, smoothed, are several thresholds of vibration: they are no vibration of the
// object, and two trackers that differ make no difference between objects.
TEST(FastForce, NoiseOfTheTrackerIsNoVibration) {
  const Thresholds thresholds;
  const auto quiet = judged_process(felt_series(presses(2000.0, 1e-7, 1), Vec3::UnitZ()), thresholds);
  const auto noisy = judged_process(felt_series(presses(2000.0, 1e-5, 2), Vec3::UnitZ()), thresholds, &quiet);
  EXPECT_NEAR(noisy.felt.position_noise_m, 1e-5, 0.03e-5);
  EXPECT_LT(quiet.felt.position_noise_m, 2e-7);
  double seen_N2 = 0.0;
  double expected_N2 = 0.0;
  for (std::size_t b = 0; b < 5; ++b) {  // 20 to 50 Hz, what the smoothing lets pass
    seen_N2 += noisy.fast.contact.power_N2[b];
    expected_N2 += noisy.fast.tracker_N2[b];
  }
  EXPECT_NEAR(expected_N2 / seen_N2, 1.0, 0.25);
  const auto difference = vibration_difference(quiet.fast, noisy.fast, 0.0, thresholds);
  EXPECT_TRUE(difference.known);
  EXPECT_LT(difference.jnd, 0.3);
}

// A force that bends within tens of milliseconds is no burst, though straight lines over depth do not follow it.
TEST(FastForce, ASlowBendIsNoBurst) {
  const Thresholds thresholds;
  const auto bent = [](double force_N) {
    Recording recording = presses(500.0, 1e-7, 3);
    Random random(4);
    for (std::size_t i = 0; i < recording.size(); ++i) {
      const double part = std::clamp(-recording.motion.p_W_m[i].z() / 0.0006, 0.0, 1.0);
      recording.f_W_N[i].z() = force_N * part * part * (3.0 - 2.0 * part) + 0.0002 * random.normal();
    }
    return recording;
  };
  const auto real = judged_process(felt_series(bent(5.0), Vec3::UnitZ()), thresholds);
  const auto weaker = judged_process(felt_series(bent(4.0), Vec3::UnitZ()), thresholds, &real);
  const auto difference = transient_difference(real.fast, weaker.fast, thresholds);
  EXPECT_TRUE(difference.known);
  EXPECT_LT(difference.jnd, 0.5);
}

}  // namespace
}  // namespace touchstone::perception
