#include "harness/perception/haptic_data_matrix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/testing/error_message.h"

namespace touchstone::perception {
namespace {

using ::testing::HasSubstr;
using touchstone::testing::message_of;

// Force 2 t, displacement t^2 / 2, on a clock with jitter.
PressSignal parabola(double jitter, std::uint64_t seed) {
  PressSignal signal;
  signal.name = "parabola";
  Random random(seed);
  for (int n = 0; n < 400; ++n) {
    const double t = 0.001 * (n + jitter * (random.uniform() - 0.5));
    signal.t_s.push_back(t);
    signal.force_N.push_back(2.0 * t);
    signal.displacement_m.push_back(0.5 * t * t);
    signal.angle_rad.push_back(3.0 * t);
  }
  return signal;
}

TEST(HapticDataMatrix, RatesOfPolynomialsAreExactBetweenTheEnds) {
  for (const int half_width : {1, 4}) {
    HapticDataMatrixOptions options;
    options.derivative_half_width = half_width;
    options.rate_Hz = 1000.0;
    const PressSignal signal = parabola(0.0, 1);
    const auto matrix = make_haptic_data_matrix(std::span(&signal, 1), options);
    ASSERT_EQ(matrix.size(), 400u);
    const double t0 = signal.t_s.front();
    for (std::size_t n = 12; n + 12 < matrix.size(); ++n) {
      const double t = t0 + matrix.t_s(n);
      const auto m = matrix.observation(n, 0);
      EXPECT_NEAR(m(0, 0), 2.0 * t, 1e-9);      // F
      EXPECT_NEAR(m(0, 1), 0.5 * t * t, 1e-9);  // S
      EXPECT_NEAR(m(0, 2), 3.0 * t, 1e-9);      // A
      EXPECT_NEAR(m(0, 3), 1.0, 1e-6);          // a: not measured, so ddS
      EXPECT_NEAR(m(1, 0), 2.0, 1e-9);          // dF
      EXPECT_NEAR(m(1, 1), t, 1e-9);            // dS
      EXPECT_NEAR(m(1, 2), 1.0, 1e-6);          // ddS
      EXPECT_NEAR(m(1, 3), 3.0, 1e-9);          // dA
    }
  }
}

TEST(HapticDataMatrix, JitterIsResampledOnTheCommonTimeOfAllParts) {
  PressSignal late = parabola(0.4, 2);
  late.name = "late";
  late.t_s.erase(late.t_s.begin(), late.t_s.begin() + 100);
  late.force_N.erase(late.force_N.begin(), late.force_N.begin() + 100);
  late.displacement_m.erase(late.displacement_m.begin(), late.displacement_m.begin() + 100);
  late.angle_rad.clear();
  const std::vector<PressSignal> parts{parabola(0.4, 3), late};
  const auto matrix = make_haptic_data_matrix(parts);
  EXPECT_EQ(matrix.parts.size(), 2u);
  EXPECT_NEAR(matrix.rate_Hz, 1000.0, 30.0);
  EXPECT_NEAR(matrix.duration_s(), 0.3, 0.01);
  for (std::size_t n = 0; n < matrix.size(); ++n) {
    // Linear in time: interpolation loses nothing, and both parts show the same moment.
    EXPECT_NEAR(matrix.observation(n, 0)(0, 0), matrix.observation(n, 1)(0, 0), 1e-9);
    EXPECT_EQ(matrix.observation(n, 1)(0, 2), 0.0);
  }
}

TEST(HapticDataMatrix, SaysWhatIsWrongAndWhere) {
  const auto refused = [](const std::function<void(PressSignal&)>& spoil) {
    PressSignal signal = parabola(0.0, 1);
    spoil(signal);
    return message_of<Error>([&] { make_haptic_data_matrix(std::span(&signal, 1)); });
  };
  EXPECT_THAT(refused([](PressSignal& s) { s.force_N[7] = std::numeric_limits<double>::quiet_NaN(); }),
              HasSubstr("parabola: force of sample 8"));
  EXPECT_THAT(refused([](PressSignal& s) { s.t_s[9] = s.t_s[8]; }),
              HasSubstr("time does not advance from sample 9 to 10"));
  EXPECT_THAT(refused([](PressSignal& s) { s.force_N.pop_back(); }), HasSubstr("force has 399 values for 400 times"));
  EXPECT_THAT(refused([](PressSignal& s) {
                for (std::size_t n = 200; n < 400; ++n) s.t_s[n] += 1.0;
              }),
              HasSubstr("a hole of 1.001 s"));
  EXPECT_THAT(refused([](PressSignal& s) {
                s.t_s.resize(3);
                s.force_N.resize(3);
                s.displacement_m.resize(3);
                s.angle_rad.resize(3);
              }),
              HasSubstr("3 samples are too few"));
  EXPECT_THAT(message_of<Error>([] { make_haptic_data_matrix({}); }), HasSubstr("at least one measuring part"));
}

TEST(PressSignal, ProjectsOnTheDirectionOfTheForce) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    const Vec3 n = random.direction();
    const double stiffness = random.log_uniform(1e-2, 1e5);
    const double unit = random.log_uniform(1e-3, 1e3);
    recording::Recording recording;
    recording.source = "press.csv";
    const Vec3 contact = random.direction();
    for (int i = 0; i < 100; ++i) {
      const double depth = unit * (i < 10 ? -0.1 : 0.01 * (i - 10));
      recording.motion.t_s.push_back(0.001 * i);
      recording.motion.p_W_m.push_back(contact - depth * n);
      recording.f_W_N.push_back(std::max(depth, 0.0) * stiffness * n);
    }
    const Vec3 found = press_direction(recording);
    EXPECT_LT((found - n).norm(), 1e-12);
    const auto signal = press_signal(recording, found, 1e-6 * stiffness * unit);
    EXPECT_NEAR(signal.displacement_m[11], 0.0, 1e-12 * std::max(1.0, unit));  // the first sample with force
    EXPECT_NEAR(signal.displacement_m[99] - signal.displacement_m[11], 0.88 * unit, 1e-9 * std::max(1.0, unit));
    EXPECT_NEAR(signal.force_N[99], 0.89 * unit * stiffness, 1e-9 * unit * stiffness);
  }
  recording::Recording undirected;
  undirected.source = "noise.csv";
  undirected.f_W_N = {Vec3::UnitX(), -Vec3::UnitX()};
  EXPECT_THAT(message_of<Error>([&] { press_direction(undirected); }),
              HasSubstr("noise.csv: the force has no direction"));
  undirected.f_W_N.clear();
  undirected.motion.t_s = {0.0, 1.0};
  undirected.motion.p_W_m = {Vec3::Zero(), Vec3::Zero()};
  EXPECT_THAT(message_of<Error>([&] { press_signal(undirected, Vec3::UnitZ(), 0.06); }), HasSubstr("has no force"));
}

}  // namespace
}  // namespace touchstone::perception
