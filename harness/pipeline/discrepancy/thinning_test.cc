#include "harness/pipeline/discrepancy/thinning.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::pipeline {
using recording::Recording;

namespace {

Recording line(std::size_t samples, double step_s) {
  Recording recording;
  for (std::size_t i = 0; i < samples; ++i) {
    const double t_s = 3.0 + step_s * static_cast<double>(i);
    recording.motion.t_s.push_back(t_s);
    recording.motion.p_W_m.emplace_back(0.01 * t_s, -0.02 * t_s, 0.0);
    recording.f_W_N.emplace_back(std::sin(t_s), 1.0, t_s);
  }
  return recording;
}

TEST(Thinning, LeavesFourSamplesInABlockAndSlowRecordingsAsTheyAre) {
  constexpr double window_s = 2.0 / 60.0;
  EXPECT_EQ(samples_per_mean(line(1000, 0.001).motion, window_s), 8U);
  EXPECT_EQ(samples_per_mean(line(1000, 0.002).motion, window_s), 4U);
  EXPECT_EQ(samples_per_mean(line(1000, 0.004).motion, window_s), 2U);
  EXPECT_EQ(samples_per_mean(line(1000, 1.0 / 60.0).motion, window_s), 1U);
}

TEST(Thinning, MeansOfALineLieOnItAndNothingIsLost) {
  const Recording all = line(1001, 0.002);
  const Recording few = thinned(all, 4, {});
  ASSERT_EQ(few.size(), 251U);
  EXPECT_EQ(few.motion.t_s.front(), all.motion.t_s.front());
  double sum_N = few.f_W_N.front().z();
  for (std::size_t i = 1; i < few.size(); ++i) {
    EXPECT_NEAR(few.motion.p_W_m[i].x(), 0.01 * few.motion.t_s[i], 1e-12);
    sum_N += 4.0 * few.f_W_N[i].z();
  }
  double whole_N = 0.0;
  for (const Vec3& f : all.f_W_N) whole_N += f.z();
  EXPECT_NEAR(sum_N, whole_N, 1e-9 * whole_N);
}

// Forces of blocks that are held back are not in any mean of those that are learnt from.
TEST(Thinning, NoMeanReachesAcrossTheBorderOfAPart) {
  const discrepancy::Part learnt{{0.05, false}, {}};
  Recording all = line(2000, 0.002);
  const double first_s = all.motion.t_s.front();
  const Recording clean = thinned(all, 4, learnt);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!learnt.contains(all.motion.t_s[i], first_s)) all.f_W_N[i] += Vec3(1e6, 1e6, 1e6);
  }
  const Recording spoilt = thinned(all, 4, learnt);
  ASSERT_EQ(spoilt.size(), clean.size());
  for (std::size_t i = 0; i < clean.size(); ++i) {
    if (learnt.contains(clean.motion.t_s[i], first_s)) {
      EXPECT_EQ(spoilt.f_W_N[i], clean.f_W_N[i]) << i;
    } else {
      EXPECT_GT(spoilt.f_W_N[i].x(), 9e5) << i;
    }
  }
}

// Against the noise itself, drawn at the sensor's rate and averaged.
TEST(Thinning, TheNoiseOfMeansIsThatOfTheAveragedSensor) {
  discrepancy::InstrumentDescription sensor;
  sensor.force_noise_N = 0.02;
  sensor.force_step_N = Vec3(0.01, 0.0, 0.03);
  for (const double time_constant_s : {0.0, 0.003, 0.02}) {
    sensor.force_noise_time_constant_s = time_constant_s;
    Recording drawn = line(80000, 0.001);
    Random random(5);
    drawn.f_W_N = force_noise(drawn.motion, sensor, random);
    const Recording means = thinned(drawn, 8, {});
    const auto square_of = [](const std::vector<Vec3>& forces) {
      double sum = 0.0;
      for (const Vec3& f : forces) sum += f.squaredNorm();
      return sum / static_cast<double>(forces.size());
    };
    const discrepancy::InstrumentDescription of_means = instrument_of_means(sensor, drawn.motion, 8);
    // 10,000 means of three axes, each like the next over the time constant: a few per cent.
    EXPECT_NEAR(square_beyond_means_N2(of_means, {}) / square_of(means.f_W_N), 1.0, 0.06) << time_constant_s;
    EXPECT_NEAR(square_beyond_means_N2(sensor, of_means) / (square_of(drawn.f_W_N) - square_of(means.f_W_N)), 1.0, 0.06)
        << time_constant_s;
  }
}

}  // namespace
}  // namespace touchstone::pipeline
