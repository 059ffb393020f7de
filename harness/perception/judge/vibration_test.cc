#include "harness/perception/judge/vibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "harness/perception/judge/judge.h"

namespace touchstone::perception {
namespace {

// Presses on a spring, once from the air, seen by a noisy tracker and a quiet force sensor.
recording::Recording presses(double k_N_per_m, double position_noise_m, std::uint64_t seed) {
  Random random(seed);
  recording::Recording recording;
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
  // Left in, it would be noticed.
  auto left_in = noisy.fast;
  for (double& power : left_in.tracker_N2) power = 0.0;
  EXPECT_GT(vibration_difference(quiet.fast, left_in, 0.0, thresholds).jnd, 1.0);
}

}  // namespace
}  // namespace touchstone::perception
