#include "harness/pipeline/discrepancy/force_gap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"
#include "harness/pipeline/discrepancy/thinning.h"
#include "harness/rendering/predictor.h"

namespace touchstone::pipeline {
using recording::Recording;
using rendering::Model;

namespace {

constexpr double window_s = 2.0 / 60.0;
constexpr std::size_t count = 8;

Model plane(double damper_N_s_per_m) {
  Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = 900.0;
  if (damper_N_s_per_m > 0.0) {
    model.effects.push_back({"viscous-friction", {{"coefficient_N_s_per_m", damper_N_s_per_m}}, ""});
  }
  return model;
}

// Presses and circles for 12 s at 1 kHz.
MotionColumns fast_hand(double phase) {
  MotionColumns motion;
  for (int i = 0; i < 12000; ++i) {
    const double t = 0.001 * i;
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(0.02 * std::sin(1.3 * t + phase), 0.015 * std::cos(2.1 * t),
                              0.001 - 0.002 * std::sin(3.0 * t + phase));
  }
  return motion;
}

// A plane with a damper of 4 N s/m along it under a tracker whose noise is as fast as the sensor.
struct World {
  explicit World(double position_noise_m, double buzz_N = 0.0) {
    sensor.force_noise_N = 0.01;
    sensor.position_noise_m = position_noise_m;
    sensor.position_rate_Hz = 1000.0;
    for (Recording* const one : {&train, &holdout}) {
      const MotionColumns path = fast_hand(one == &train ? 0.0 : 0.7);
      auto f_W_N = discrepancy::PlanePredictor(path).predict(plane(4.0)).f_W_N;
      for (std::size_t i = 0; i < f_W_N.size(); ++i) {
        f_W_N[i].x() += buzz_N * std::sin(2.0 * std::numbers::pi * 150.0 * path.t_s[i]);
      }
      *one = discrepancy::measured(path, f_W_N, sensor, one == &train ? 1 : 2);
    }
  }

  [[nodiscard]] MeasuredGap measure(const Model& found) const {
    const rendering::MakePredictor make = [](const MotionColumns& motion) {
      return std::make_unique<discrepancy::PlanePredictor>(motion);
    };
    static Recording train_means, holdout_means;  // what comes back points to them
    train_means = thinned(train, count, {});
    holdout_means = thinned(holdout, count, {});
    const auto of_train = make(train_means.motion), of_holdout = make(holdout_means.motion), own = make(holdout.motion);
    discrepancy::SearchData data;
    data.learning = {&train_means, of_train.get(), nullptr, {}};
    data.holdout = {&holdout_means, of_holdout.get(), nullptr, {}};
    discrepancy::SearchResult search;
    search.start = plane(0.0);
    search.model = found;
    search.noise_rms_N = 0.02;
    search.spectrum = spectrum_of_samples({&train, &holdout, 1, sensor, make}, found, window_s);
    return measure_gap(search, data, {{&holdout, own.get(), nullptr, {}}, count, 3e-4});
  }
  [[nodiscard]] bool tells_of_means(const MeasuredGap& measured) const { return measured.on.recording != &holdout; }

  discrepancy::InstrumentDescription sensor;
  Recording train;
  Recording holdout;
};

TEST(ForceGap, WhatATrueDamperMakesOfTheTrackersNoiseIsNoErrorOfItsOwn) {
  const World world(1e-4);
  const MeasuredGap measured = world.measure(plane(4.0));
  ASSERT_TRUE(world.tells_of_means(measured));
  const discrepancy::ForceGap& gap = measured.gap;
  ASSERT_TRUE(gap.means);
  EXPECT_EQ(gap.means->count, count);
  EXPECT_GT(gap.means->after_N, gap.means->before_N);
  EXPECT_LT(gap.holdout_after_N, gap.holdout_before_N);
  EXPECT_FALSE(gap.rises());
  EXPECT_EQ(gap.noise_floor_N, 0.02);
}

TEST(ForceGap, ADamperThatIsWrongRaisesTheErrorOfMeansTooAndIsToldAtSingleSamples) {
  const World world(1e-4);
  const MeasuredGap measured = world.measure(plane(20.0));
  EXPECT_FALSE(world.tells_of_means(measured));
  EXPECT_FALSE(measured.gap.means);
  EXPECT_TRUE(measured.gap.rises());
}

TEST(ForceGap, WhatNoNoiseMakesStaysInTheErrorOfSingleSamples) {
  const World world(1e-4, 1.2);
  const MeasuredGap measured = world.measure(plane(4.0));
  EXPECT_TRUE(measured.gap.rises());
  EXPECT_FALSE(world.tells_of_means(measured));
}

TEST(ForceGap, WithoutSuchNoiseSingleSamplesAreToldOf) {
  const World world(0.0);
  const MeasuredGap measured = world.measure(plane(4.0));
  EXPECT_FALSE(world.tells_of_means(measured));
  EXPECT_NEAR(measured.gap.holdout_after_N, std::sqrt(3.0) * world.sensor.force_noise_N, 1e-3);
  EXPECT_NEAR(measured.gap.noise_floor_N, std::sqrt(0.02 * 0.02 + 3e-4), 1e-12);
}

// Forces of 1 N are told apart from 1.2 N, of 5 N from 5.35 N (Weber fractions of 20 and 7 %); what is not felt counts
// for nothing.
TEST(LeftInJnd, IsTheErrorOverWhatIsNoticedAtThatForce) {
  Recording held_out;
  rendering::Prediction prediction;
  const auto add = [&](double measured_N, const Vec3& error_N, int samples) {
    for (int i = 0; i < samples; ++i) {
      held_out.motion.t_s.push_back(0.001 * static_cast<double>(held_out.size()));
      held_out.motion.p_W_m.emplace_back(Vec3::Zero());
      held_out.f_W_N.emplace_back(0.0, measured_N, 0.0);
      prediction.f_W_N.push_back(held_out.f_W_N.back() + error_N);
    }
  };
  const discrepancy::Evidence evidence{&held_out, nullptr, nullptr, {}};
  add(0.0, Vec3(0.0, 0.0, 0.01), 100);
  EXPECT_TRUE(std::isnan(left_in_jnd(evidence, prediction))) << "nothing is felt";
  add(1.0, Vec3(0.06, 0.0, 0.08), 50);
  EXPECT_NEAR(left_in_jnd(evidence, prediction), 0.5, 1e-12);
  add(5.0, Vec3(0.0, 0.35, 0.0), 50);
  EXPECT_NEAR(left_in_jnd(evidence, prediction), std::sqrt((0.25 + 1.0) / 2.0), 1e-12);
}

}  // namespace
}  // namespace touchstone::pipeline
