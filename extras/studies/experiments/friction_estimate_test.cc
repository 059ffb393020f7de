// What makes a coefficient of friction out of fits: two probes, and scans measured again.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/friction_experiment.h"

namespace touchstone::experiments {
using recording::Recording;

namespace {

TEST(FrictionEstimate, OfARigidProbeIsFreeOfWhatGoesWithOneOverTheStiffness) {
  const auto found = [](double stiffness_N_per_m) { return 0.3 - 12.0 / stiffness_N_per_m; };
  EXPECT_NEAR(of_a_rigid_probe(found(soft_probe_N_per_m), found(stiff_probe_N_per_m)), 0.3, 1e-15);
  EXPECT_DOUBLE_EQ(of_a_rigid_probe(0.25, 0.25), 0.25);
}

TEST(FrictionEstimate, FollowsTheErrorsBackToNoneAndCarriesTheirSpread) {
  const FrictionEstimate estimate = friction_estimate(0.24, {0.22, 0.24, 0.23});
  EXPECT_DOUBLE_EQ(estimate.again_mu, 0.23);
  EXPECT_DOUBLE_EQ(estimate.mu, 0.25);
  EXPECT_NEAR(estimate.standard_error, 0.01 * std::sqrt(4.0 / 3.0), 1e-15);
  EXPECT_EQ(estimate.measured, 3U);
  EXPECT_THROW(friction_estimate(0.24, {0.23}), std::invalid_argument);
}

// A tip at rest, pressed by 2 N, its sensor turned by 90 degrees about x.
Recording resting(std::size_t samples, double rate_Hz) {
  Recording recording;
  for (std::size_t i = 0; i < samples; ++i) {
    recording.motion.t_s.push_back(0.5 + static_cast<double>(i) / rate_Hz);
    recording.motion.p_W_m.emplace_back(0.01, 0.02, 0.03);
    recording.motion.q_WS.emplace_back(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0);
    recording.f_W_N.emplace_back(0.0, 0.0, 2.0);
  }
  return recording;
}

TEST(MeasuredAgain, ByPerfectInstrumentsIsTheSame) {
  const Recording recording = resting(200, 60.0);
  datasets::Tracker tracker = datasets::Tracker::perfect();
  tracker.rate_Hz = 60.0;
  const Recording again = measured_again(recording, datasets::ForceSensor::perfect(), tracker, 1);
  ASSERT_EQ(again.size(), recording.size());
  for (std::size_t i = 0; i < recording.size(); ++i) {
    EXPECT_EQ(again.motion.t_s[i], recording.motion.t_s[i]);
    EXPECT_EQ(again.motion.p_W_m[i], recording.motion.p_W_m[i]);
    EXPECT_LT((again.f_W_N[i] - recording.f_W_N[i]).norm(), 1e-15);
  }
}

TEST(MeasuredAgain, AddsTheInstrumentsErrorsOnceMoreAndOthersForOtherSeeds) {
  const Recording recording = resting(3000, 60.0);
  const datasets::Tracker tracker;
  datasets::ForceSensor sensor;
  sensor.drift_N_per_sqrt_s = 0.0;
  const Recording again = measured_again(recording, sensor, tracker, 1);
  const Recording same = measured_again(recording, sensor, tracker, 1);
  const Recording other = measured_again(recording, sensor, tracker, 2);
  double steps = 0.0;
  double force = 0.0;
  for (std::size_t i = 1; i < recording.size(); ++i) {
    ASSERT_EQ(again.motion.p_W_m[i], same.motion.p_W_m[i]);
    ASSERT_EQ(again.f_W_N[i], same.f_W_N[i]);
    ASSERT_NE(again.motion.p_W_m[i], other.motion.p_W_m[i]);
    steps += (again.motion.p_W_m[i] - again.motion.p_W_m[i - 1]).squaredNorm();
    force += std::pow(again.f_W_N[i].z() - 2.0, 2);
  }
  // From one sample to the next: the part that is new for every sample twice, and 1/240 of the wander's variance twice.
  const double expected = 6.0 * (std::pow(tracker.noise_m, 2) + std::pow(tracker.wander_m, 2) / 240.0);
  EXPECT_NEAR(steps / 2999.0, expected, 0.06 * expected);
  EXPECT_GT(std::sqrt(force / 2999.0), 0.5 * sensor.coloured_noise_N);
  EXPECT_LT(std::sqrt(force / 2999.0), 1.2 * std::hypot(sensor.coloured_noise_N, sensor.white_noise_N));
}

}  // namespace
}  // namespace touchstone::experiments
