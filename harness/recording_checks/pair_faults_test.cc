#include "harness/recording_checks/pair_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/random.h"
#include "harness/recording_checks/recording_sample.h"

namespace touchstone::recording_checks {
using recording::Recording;

namespace {

// Irregular presses, sampled at `rate_Hz`, the force late by `late_s`.
Recording pressed_run(Random& random, double rate_Hz, double late_s = 0.0) {
  Recording r;
  r.source = "presses.csv";
  const auto load = [](double t) {
    return std::max(0.0, std::sin(3.0 * t) + std::sin(4.7 * t + 1.0) + 0.5 * std::sin(7.3 * t));
  };
  for (int i = 0; i < static_cast<int>(20.0 * rate_Hz); ++i) {
    const double t = i / rate_Hz;
    r.motion.t_s.push_back(t);
    r.motion.p_W_m.emplace_back(0.04 * std::sin(0.6 * t), 0.03 * std::cos(0.4 * t), -1e-3 * load(t));
    r.motion.q_WS.push_back(Quat(Eigen::AngleAxisd(1.5 * std::sin(0.7 * t), Vec3::UnitX())));
    r.f_W_N.push_back(Vec3(0.1 * load(t - late_s), 0.0, load(t - late_s)) +
                      0.01 * Vec3(random.normal(), random.normal(), random.normal()));
  }
  return r;
}

std::string named(const Recording& a, const Recording& b) {
  std::string names;
  for (const RecordingFinding& f : find_pair_faults(a, b)) names += (names.empty() ? "" : ", ") + finding_line(f);
  return names;
}

TEST(PairFaults, EachIsNamedWithItsRepairAndTwoGoodOnesAreNot) {
  using ::testing::HasSubstr;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const Recording one = pressed_run(random, 250.0), other = pressed_run(random, 100.0);
    EXPECT_EQ(named(one, other), "") << seed;
    Recording bad = other;
    flip_force(bad);
    EXPECT_THAT(named(one, bad), HasSubstr("--flip-force")) << seed;
    bad = other;
    for (Vec3& p : bad.motion.p_W_m) p *= 1e3;
    EXPECT_THAT(named(one, bad), HasSubstr("positions are 1000 times too large")) << seed;
    bad = other;
    for (std::size_t i = 0; i < bad.size(); ++i) bad.f_W_N[i] = bad.motion.q_WS[i].conjugate() * bad.f_W_N[i];
    EXPECT_THAT(named(one, bad), HasSubstr("\"force_frame\": \"sensor\"")) << seed;
    for (const double late_s : {0.15, -0.15}) {
      const std::string message = named(one, pressed_run(random, 100.0, late_s));
      EXPECT_THAT(message, HasSubstr(late_s > 0.0 ? "0.15 s later" : "0.15 s earlier")) << seed;
      EXPECT_THAT(message, HasSubstr(late_s > 0.0 ? "\"shift_force_s\": -0.15" : "\"shift_force_s\": 0.15"));
    }
  }
}

// Pressed on a slope, so that every axis holds a part of the load.
TEST(PairFaults, MirroredAndExchangedAxesAreNamed) {
  using ::testing::HasSubstr;
  Random random(21);
  const Mat3 slope = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3(0.5, -0.3, 0.8)).toRotationMatrix();
  Recording one = pressed_run(random, 250.0), mirrored = pressed_run(random, 100.0);
  for (Vec3& f : one.f_W_N) f = slope * f;
  for (Vec3& f : mirrored.f_W_N) f = slope * f;
  EXPECT_EQ(named(one, mirrored), "");
  Recording exchanged = mirrored;
  for (Vec3& f : mirrored.f_W_N) f.z() = -f.z();
  for (Vec3& f : exchanged.f_W_N) std::swap(f.x(), f.z());
  EXPECT_THAT(named(one, mirrored), HasSubstr("fz has the other sign"));
  EXPECT_THAT(named(one, exchanged), HasSubstr("fx and fz are exchanged"));
}

TEST(PairFaults, AnotherForceIsNoFaultOfTheFile) {
  Random random(7);
  const Recording one = pressed_run(random, 250.0);
  Recording stiffer = one;
  for (Vec3& f : stiffer.f_W_N) f *= 3.0;
  EXPECT_EQ(named(one, stiffer), "");
  EXPECT_EQ(named(one, one), "");
  EXPECT_EQ(named({}, {}), "");
}

// Round and round with friction: a quarter of a turn later, the force of the friction has exchanged its axes.
TEST(PairFaults, AnotherHandIsNoFaultOfTheFile) {
  const auto circled = [](double phase) {
    Recording r;
    r.source = "circled.csv";
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.005 * i;
      const double angle = 5.0 * t + phase;
      r.motion.t_s.push_back(t);
      r.motion.p_W_m.emplace_back(0.015 * std::cos(angle), 0.015 * std::sin(angle), -0.002);
      r.f_W_N.emplace_back(0.6 * std::sin(angle), -0.6 * std::cos(angle), 1.1);
    }
    return r;
  };
  for (const double phase : {1.2, 1.6, 2.9}) EXPECT_EQ(named(circled(0.0), circled(phase)), "") << phase;
  // The same way at another place is one motion.
  Recording mirrored = circled(0.0);
  for (Vec3& p : mirrored.motion.p_W_m) p += Vec3(0.2, 0.1, 0.0);
  for (Vec3& f : mirrored.f_W_N) f.x() = -f.x();
  EXPECT_THAT(named(circled(0.0), mirrored), ::testing::HasSubstr("fx has the other sign"));
}

}  // namespace
}  // namespace touchstone::recording_checks
