#include "harness/recording_checks/column_faults.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/random.h"

namespace touchstone::recording_checks {
using recording::Recording;

namespace {

// Presses at 500 Hz for 10 s, with noise, rounded as files round.
Recording presses(Random& random) {
  Recording r;
  for (int i = 0; i < 5000; ++i) {
    const double t = 0.002 * i;
    const double depth = 1e-3 * std::sin(4.0 * t);
    r.motion.t_s.push_back(t);
    r.motion.p_W_m.emplace_back(1e-7 * std::round(1e7 * 0.01 * std::sin(0.3 * t)), 0.0,
                                1e-7 * std::round(-1e7 * depth));
    r.f_W_N.emplace_back(0.003 * std::round(random.normal()), 0.003 * std::round(random.normal()),
                         0.003 * std::round(std::max(0.0, 500.0 * depth) / 0.003 + 2.0 * random.normal()));
  }
  return r;
}

std::string faults_of(const Recording& r) {
  std::string names;
  for (const ColumnFault& fault : find_column_faults(r))
    names += (names.empty() ? "" : ", ") + std::string(to_string(fault.fault));
  return names;
}

TEST(ColumnFaults, PlantedFaultsAreNamed) {
  Random random(1);
  for (int world = 0; world < 20; ++world) {
    const Recording good = presses(random);
    EXPECT_EQ(faults_of(good), "");
    Recording stuck = good;
    for (std::size_t i = 1000; i < 1600; ++i) stuck.motion.p_W_m[i] = stuck.motion.p_W_m[1000];
    EXPECT_EQ(faults_of(stuck), "stuck position");
    Recording frozen = good;
    for (std::size_t i = 1150; i < 1600; ++i) frozen.f_W_N[i] = Vec3(0.003, 0.0, 0.3);
    EXPECT_EQ(faults_of(frozen), "stuck force");
    // Back where it stopped: the noise that is missing shows it.
    Recording held = good;
    for (std::size_t i = 1150; i < 1600; ++i) held.f_W_N[i] = held.f_W_N[1600];
    EXPECT_EQ(faults_of(held), "stuck force");
    Recording clipped = good;
    for (Vec3& f : clipped.f_W_N) f.z() = std::min(f.z(), 0.3);
    EXPECT_EQ(faults_of(clipped), "saturated force");
    Recording twice = good;
    for (std::size_t i = 0; i < 300; ++i) {
      twice.motion.p_W_m[3017 + i] = twice.motion.p_W_m[2001 + i];
      twice.f_W_N[3017 + i] = twice.f_W_N[2001 + i];
    }
    EXPECT_EQ(faults_of(twice), "repeated samples");
  }
}

// Presses of 2 Hz at 66 Hz with a sensor quiet to a thousandth of the load: no step turns, the noise shows in the
// fourth differences alone. As the palpation runs are.
Recording quiet_presses(Random& random) {
  Recording r;
  for (int i = 0; i < 2000; ++i) {
    const double t = i / 66.0, load = 1.0 + 0.8 * std::sin(12.6 * t);
    const auto noisy = [&](double value) { return 1e-5 * std::round(1e5 * (value + 0.002 * random.normal())); };
    r.motion.t_s.push_back(t);
    r.motion.p_W_m.emplace_back(1e-7 * std::round(1e5 * t), 0.0, 1e-7 * std::round(-2e4 * load));
    r.f_W_N.emplace_back(noisy(0.14 * load), noisy(0.3 * std::sin(0.5 * t)), noisy(load));
  }
  return r;
}

TEST(ColumnFaults, NoiseBelowTheStepsOfTheMotionShowsWhatStandsStill) {
  Random random(3);
  for (int world = 0; world < 20; ++world) {
    const Recording good = quiet_presses(random);
    EXPECT_EQ(faults_of(good), "");
    Recording stuck = good;
    for (std::size_t i = 901; i < 1033; ++i) stuck.f_W_N[i] = stuck.f_W_N[900];
    ASSERT_EQ(faults_of(stuck), "stuck force");
    EXPECT_NE(find_column_faults(stuck).front().message.find("133 samples, 13.64 s to 15.64 s"), std::string::npos)
        << find_column_faults(stuck).front().message;
    Recording dead = good;
    for (Vec3& f : dead.f_W_N) f.x() = 0.137;
    EXPECT_EQ(faults_of(dead), "constant force");
    Recording broken = good;  // a cable, in the middle of the run
    for (std::size_t i = 1200; i < broken.size(); ++i) broken.f_W_N[i].y() = 0.0371;
    ASSERT_EQ(faults_of(broken), "constant force");
    EXPECT_NE(find_column_faults(broken).front().message.find("fy stands at exactly 0.0371 N in 800 samples, 18.18 s"),
              std::string::npos)
        << find_column_faults(broken).front().message;
  }
}

// What was computed has no noise but that of rounding, and may stand still.
TEST(ColumnFaults, ComputedForcesMayStandStill) {
  for (const double quantum : {1e-3, 1e-5, 1e-12}) {
    Recording r;
    for (int i = 0; i < 3000; ++i) {
      const double t = 0.002 * i;
      const double load = i < 1000 || i >= 1400 ? 1.0 + 0.5 * std::sin(2.0 * t) : 1.0 + 0.5 * std::sin(2.0 * 2.0);
      const auto rounded = [&](double value) { return quantum * std::round(value / quantum); };
      r.motion.t_s.push_back(t);
      r.motion.p_W_m.emplace_back(1e-7 * std::round(1e5 * t), 0.0, 1e-7 * std::round(-2e4 * load));
      r.f_W_N.emplace_back(rounded(0.2 * std::sin(t)), rounded(0.1 * std::cos(t)), rounded(load));
    }
    EXPECT_EQ(faults_of(r), "") << quantum;
    for (Vec3& f : r.f_W_N) f.x() = 0.137;
    EXPECT_EQ(faults_of(r), "") << quantum;
  }
}

TEST(ColumnFaults, OneAxisConstantLoadAndRestAreLegitimate) {
  Random random(2);
  Recording axis = presses(random);
  for (std::size_t i = 0; i < axis.size(); ++i) {
    axis.motion.p_W_m[i] = Vec3(0, 0, axis.motion.p_W_m[i].z());
    axis.f_W_N[i] = Vec3(0, 0, axis.f_W_N[i].z());
  }
  EXPECT_EQ(faults_of(axis), "");
  Recording constant = axis;
  for (Vec3& f : constant.f_W_N) f = Vec3(0, 0, 2.0);
  EXPECT_EQ(faults_of(constant), "");
  Recording rest = presses(random);
  for (std::size_t i = 2000; i < 5000; ++i) rest.motion.p_W_m[i] = rest.motion.p_W_m[1999];
  EXPECT_EQ(faults_of(rest), "");
  Recording few;
  few.motion.t_s = {0.0, 1.0};
  few.motion.p_W_m = {Vec3::Zero(), Vec3::Ones()};
  few.f_W_N = {Vec3::Zero(), Vec3::Ones()};
  EXPECT_EQ(faults_of(few), "");
}

}  // namespace
}  // namespace touchstone::recording_checks
