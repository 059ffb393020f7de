// The instrument models: what is added is kept to the bit, each effect alone has the statistics that it states, and all
// switched off is the truth.
#include <gmock/gmock.h>

#include <cmath>

#include "force_sensor.h"
#include "tracker.h"

namespace touchstone::datasets {
namespace {

constexpr std::uint64_t seed = 5000;

Vec3 pressing(double t) { return {0.3 * std::sin(7.0 * t), -0.2 * std::cos(3.0 * t), 2.0 + std::sin(t)}; }

double rms(const std::vector<Vec3>& values) {
  double sum = 0.0;
  for (const Vec3& v : values) sum += v.squaredNorm();
  return std::sqrt(sum / (3.0 * static_cast<double>(values.size())));
}

TEST(ForceSensor, PerfectIsTheTruth) {
  const ForceMeasurement m = ForceSensor::perfect().measure(pressing, 0.5, seed);
  ASSERT_EQ(m.t_s.size(), 2501U);
  for (std::size_t i = 0; i < m.t_s.size(); ++i) EXPECT_EQ(m.measured_S_N[i], pressing(m.t_s[i]));
}

TEST(ForceSensor, KeepsWhatItAdded) {
  ForceSensor sensor;
  sensor.bias_N = Vec3(0.1, -0.2, 0.05);
  sensor.limit_N = Vec3::Constant(2.5);
  const ForceMeasurement m = sensor.measure(pressing, 2.0, seed);
  for (std::size_t i = 0; i < m.t_s.size(); ++i) {
    const Vec3 sum = m.truth_S_N[i] + m.bias_S_N[i] + m.noise_S_N[i] + m.clipping_S_N[i] + m.rounding_S_N[i];
    EXPECT_LT((m.measured_S_N[i] - sum).norm(), 1e-14);
  }
}

TEST(ForceSensor, ReadsWholeSteps) {
  const ForceMeasurement m = ForceSensor{}.measure(pressing, 2.0, seed);
  for (const Vec3& f : m.measured_S_N) {
    for (const double counts : {f.x() * 320.0, f.y() * 320.0, f.z() * 640.0})
      EXPECT_NEAR(counts, std::round(counts), 1e-9);
  }
  // Uniform over a step: its root mean square is step / sqrt 12; both step sizes together.
  const double expected = std::sqrt((2.0 / (320.0 * 320.0) + 1.0 / (640.0 * 640.0)) / 36.0);
  EXPECT_NEAR(rms(m.rounding_S_N), expected, 0.02 * expected);
}

TEST(ForceSensor, NoiseHasItsSizeAndColour) {
  ForceSensor sensor = ForceSensor::perfect();
  sensor.coloured_noise_N = 0.01;
  const ForceMeasurement m = sensor.measure(pressing, 60.0, seed);
  // About 60 s / 0.02 s independent values on each of three axes: 1 % of the deviation; 4 of those.
  EXPECT_NEAR(rms(m.noise_S_N), 0.01, 0.0005);
  double lagged = 0.0;
  const std::size_t lag = 50;  // one time constant at 5 kHz
  for (std::size_t i = lag; i < m.t_s.size(); ++i) lagged += m.noise_S_N[i].dot(m.noise_S_N[i - lag]) / 3.0;
  lagged /= static_cast<double>(m.t_s.size() - lag);
  EXPECT_NEAR(lagged / 1e-4, std::exp(-1.0), 0.04);
}

TEST(ForceSensor, DriftGrowsWithTheRootOfTime) {
  ForceSensor sensor = ForceSensor::perfect();
  sensor.rate_Hz = 100.0;
  sensor.drift_N_per_sqrt_s = 0.01;
  double square = 0.0;
  const int runs = 400;
  for (int i = 0; i < runs; ++i) {
    square += sensor.measure(pressing, 9.0, seed + static_cast<std::uint64_t>(i)).bias_S_N.back().squaredNorm() /
              (3.0 * runs);
  }
  EXPECT_NEAR(std::sqrt(square), 0.01 * 3.0, 0.0025);
}

TEST(ForceSensor, SaturatesAtItsRange) {
  ForceSensor sensor;
  sensor.limit_N = Vec3(0.25, 12.0, 2.5);
  const ForceMeasurement m = sensor.measure(pressing, 7.0, seed);
  Box3 box;
  for (const Vec3& f : m.measured_S_N) box.extend(f);
  EXPECT_NEAR(box.max().z(), 2.5, 1e-12);
  EXPECT_NEAR(box.max().x(), 0.25, 1e-12);
  EXPECT_NEAR(box.min().x(), -0.25, 1e-12);
  EXPECT_GT(box.max().y(), 0.2);
}

TEST(ForceSensor, OneEffectDoesNotChangeAnother) {
  ForceSensor sensor;
  const ForceMeasurement all = sensor.measure(pressing, 0.2, seed);
  sensor.drift_N_per_sqrt_s = 0.0;
  sensor.step_N = Vec3::Zero();
  const ForceMeasurement some = sensor.measure(pressing, 0.2, seed);
  EXPECT_EQ(all.noise_S_N, some.noise_S_N);
  EXPECT_NE(all.noise_S_N, sensor.measure(pressing, 0.2, seed + 1).noise_S_N);
}

Tracker::Pose moving(double t) {
  return {Vec3(0.05 * t, 0.02 * std::sin(t), 0.0), Quat(Eigen::AngleAxisd(0.1 * t, Vec3::UnitX()))};
}

TEST(Tracker, PerfectIsTheTruth) {
  const PoseMeasurement m = Tracker::perfect().measure(moving, 1.0, seed);
  ASSERT_EQ(m.t_s.size(), 61U);
  for (std::size_t i = 0; i < m.t_s.size(); ++i) {
    EXPECT_EQ(m.t_s[i], static_cast<double>(i) / 60.0);
    EXPECT_EQ(m.measured_W_m[i], moving(m.t_s[i]).p_W_m);
    EXPECT_EQ(m.measured_WS[i].coeffs(), moving(m.t_s[i]).q_WS.coeffs());
  }
}

TEST(Tracker, IsBetterThanHalfAMillimetre) {
  for (std::uint64_t s = 0; s < 10; ++s) {
    const PoseMeasurement m = Tracker{}.measure(moving, 30.0, seed + s);
    for (std::size_t i = 0; i < m.t_s.size(); ++i) {
      EXPECT_LT((m.measured_W_m[i] - m.truth_W_m[i]).norm(), 5e-4);
      EXPECT_LT((m.measured_W_m[i] - m.truth_W_m[i] - m.noise_W_m[i] - m.wander_W_m[i]).norm(), 1e-15);
    }
  }
}

TEST(Tracker, NoiseIsFreshAndWanderSlow) {
  const PoseMeasurement m = Tracker{}.measure(moving, 2000.0, seed);
  EXPECT_NEAR(rms(m.noise_W_m), 4e-5, 1e-6);
  EXPECT_NEAR(rms(m.wander_W_m), 8e-5, 8e-6);
  double step = 0.0;
  for (std::size_t i = 1; i < m.t_s.size(); ++i) step += (m.wander_W_m[i] - m.wander_W_m[i - 1]).squaredNorm() / 3.0;
  step = std::sqrt(step / static_cast<double>(m.t_s.size() - 1));
  EXPECT_NEAR(step, 8e-5 * std::sqrt(2.0 * (1.0 - std::exp(-1.0 / 240.0))), 4e-7);
}

TEST(Tracker, JitterAndLagOnlyMoveTheClock) {
  Tracker tracker = Tracker::perfect();
  tracker.jitter_s = 0.002;
  tracker.lag_s = 0.01;
  const PoseMeasurement m = tracker.measure(moving, 10.0, seed);
  double spread = 0.0;
  for (std::size_t i = 1; i + 1 < m.t_s.size(); ++i) {
    EXPECT_GT(m.t_s[i], m.t_s[i - 1]);
    EXPECT_LT((m.measured_W_m[i] - moving(m.t_s[i] - 0.01).p_W_m).norm(), 1e-15);
    spread = std::max(spread, std::abs(m.t_s[i] - 0.01 - static_cast<double>(i) / 60.0));
  }
  EXPECT_LE(spread, 0.002 + 1e-12);
  EXPECT_GT(spread, 0.0019);
}

}  // namespace
}  // namespace touchstone::datasets
