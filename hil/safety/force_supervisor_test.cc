#include "safety/force_supervisor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "harness/base/random.h"
#include "harness/testing/steps.h"

namespace touchstone::hil {
namespace {

SafetyLimits supervised_limits() {
  SafetyLimits l;
  l.force_N = 3.0;
  l.slew_N_per_s = 300.0;
  l.speed_m_per_s = 0.5;
  l.workspace_W_m = Box3(Vec3(-0.05, -0.05, -0.05), Vec3(0.05, 0.05, 0.05));
  return l;
}

ForceSupervisor::Input calm(double t, const Vec3& wanted = Vec3(0, 0, 1)) {
  ForceSupervisor::Input in;
  in.now_s = t;
  in.state.t_s = t;
  in.wanted_W_N = wanted;
  in.calibrated = in.dead_man_held = true;
  return in;
}

// A supervisor that has come to 1 N at t = 0.1 s.
ForceSupervisor running() {
  ForceSupervisor s(supervised_limits());
  for (int i = 0; i <= 100; ++i) s.allow(calm(i * 1e-3));
  return s;
}

TEST(ForceSupervisor, PassesWhatIsWithinTheLimits) {
  auto s = running();
  EXPECT_EQ(s.allow(calm(0.101)), Vec3(0, 0, 1));
  EXPECT_EQ(s.tripped(), Trip::none);
}

TEST(ForceSupervisor, CommandsNothingBeforeCalibrationAndWithoutTheDeadMan) {
  ForceSupervisor s(supervised_limits());
  for (int i = 0; i < 50; ++i) {
    auto in = calm(i * 1e-3);
    in.calibrated = false;
    EXPECT_EQ(s.allow(in), Vec3(0, 0, 0));
    in.calibrated = true;
    in.dead_man_held = false;
    EXPECT_EQ(s.allow(in), Vec3(0, 0, 0));
  }
  EXPECT_EQ(s.tripped(), Trip::none);  // not yet held is not released
}

TEST(ForceSupervisor, LimitsForceAndSlewWhateverIsWanted) {
  Random random(9);
  for (int run = 0; run < 200; ++run) {
    ForceSupervisor s(supervised_limits());
    Vec3 last = Vec3::Zero();
    double t = 0.0;
    for (int i = 0; i < 100; ++i) {
      const double dt = random.uniform(1e-4, 3e-3);
      t += dt;
      const Vec3 f = s.allow(calm(t, random.uniform(0, 6) * random.direction()));
      EXPECT_LE(f.norm(), 3.0 * (1 + 1e-14));
      EXPECT_LE((f - last).norm(), (i == 0 ? 0.0 : 300.0 * dt) * (1 + 1e-10));
      last = f;
    }
    EXPECT_EQ(s.tripped(), Trip::none);
  }
}

TEST(ForceSupervisor, TripsOnEachCauseRampsDownAndStaysDown) {
  struct Case {
    Trip expected;
    void (*spoil)(ForceSupervisor::Input&);
    bool ramps;
  };
  const Case cases[] = {
      {Trip::not_finite,
       [](ForceSupervisor::Input& in) { in.wanted_W_N.x() = std::numeric_limits<double>::quiet_NaN(); }, false},
      {Trip::not_finite,
       [](ForceSupervisor::Input& in) { in.state.p_W_m.y() = std::numeric_limits<double>::infinity(); }, false},
      {Trip::not_finite, [](ForceSupervisor::Input& in) { in.now_s = std::numeric_limits<double>::quiet_NaN(); },
       false},
      {Trip::force, [](ForceSupervisor::Input& in) { in.wanted_W_N = Vec3(0, 0, 7); }, true},
      {Trip::speed, [](ForceSupervisor::Input& in) { in.state.v_W_m_per_s = Vec3(0.6, 0, 0); }, true},
      {Trip::workspace, [](ForceSupervisor::Input& in) { in.state.p_W_m = Vec3(0, 0, 0.06); }, true},
      {Trip::stale, [](ForceSupervisor::Input& in) { in.state.t_s -= 0.05; }, false},
      {Trip::stale, [](ForceSupervisor::Input& in) { in.now_s += 0.1, in.state.t_s += 0.1; }, false},
      {Trip::dead_man, [](ForceSupervisor::Input& in) { in.dead_man_held = false; }, true},
      {Trip::device_error, [](ForceSupervisor::Input& in) { in.device_error = true; }, false},
      {Trip::time_ran_back, [](ForceSupervisor::Input& in) { in.now_s = in.state.t_s = 0.05; }, false},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(to_string(c.expected));
    auto s = running();
    auto in = calm(0.101);
    c.spoil(in);
    const Vec3 at_trip = s.allow(in);
    EXPECT_EQ(s.tripped(), c.expected);
    EXPECT_LE(at_trip.norm(), 1.0);
    if (!c.ramps) {
      EXPECT_EQ(at_trip, Vec3(0, 0, 0));
    }
    Vec3 last = at_trip;
    for (const double t : testing::steps(0.202, 0.4, 1e-3)) {  // the cause is gone, the trip is not
      const Vec3 f = s.allow(calm(t));
      EXPECT_LE(f.norm(), last.norm() + 1e-15);
      last = f;
    }
    EXPECT_EQ(last, Vec3(0, 0, 0));
    EXPECT_FALSE(s.reset(Trip::asked));
    EXPECT_TRUE(s.reset(c.expected));
    s.allow(calm(1.0));
    EXPECT_GT(s.allow(calm(1.001)).norm(), 0.0);
  }
}

// A spring of 500 N/m at x = 0, pressed 10 mm deep by a hand and let out again: it gives back what was put in. One that
// is stiffer on the way out gives more, and trips.
TEST(ForceSupervisor, EnergyLetsThePassivePassAndStopsTheActive) {
  const auto press = [](double stiffness_out_N_per_m) {
    auto l = supervised_limits();
    l.force_N = 20.0;
    l.slew_N_per_s = 1e6;
    l.energy_J = 0.005;
    ForceSupervisor s(l);
    for (int i = 0; i <= 1000; ++i) {
      const double t = 1e-3 * i, phase = 3.14159265358979 * t;
      auto in = calm(t);
      in.state.p_W_m.x() = -0.01 * std::sin(phase);
      in.state.v_W_m_per_s.x() = -0.01 * 3.14159265358979 * std::cos(phase);
      in.wanted_W_N = Vec3(-(i < 500 ? 500.0 : stiffness_out_N_per_m) * in.state.p_W_m.x(), 0, 0);
      s.allow(in);
    }
    return s.tripped();
  };
  EXPECT_EQ(press(500.0), Trip::none);
  EXPECT_EQ(press(800.0), Trip::energy);  // 0.015 J more than was put in
}

TEST(ForceSupervisor, PowerIsLimited) {
  auto l = supervised_limits();
  l.power_W = 0.2;
  ForceSupervisor s(l);
  for (int i = 0; i <= 100; ++i) s.allow(calm(i * 1e-3));
  auto in = calm(0.101);
  in.state.v_W_m_per_s = Vec3(0, 0, -0.3);  // the hand works against 1 N: it may
  s.allow(in);
  EXPECT_EQ(s.tripped(), Trip::none);
  in = calm(0.102);
  in.state.v_W_m_per_s = Vec3(0, 0, 0.3);
  s.allow(in);
  EXPECT_EQ(s.tripped(), Trip::power);
}

// Pulses of 2 N at 0.4 m/s on the way out, 2 ms of zero between: each gives 14 mJ, less than the limit of 0.1 J.
TEST(ForceSupervisor, AWallThatChattersAddsUp) {
  auto l = supervised_limits();
  l.energy_J = 0.1;
  l.slew_N_per_s = 1e4;
  l.ramp_down_s = 0.0;
  ForceSupervisor s(l);
  double given_J = 0.0, last_N = 0.0, t = 0.0;
  int pulses = 0;
  for (; pulses < 60 && s.tripped() == Trip::none; ++pulses) {
    for (int i = 0; i < 20; ++i, t += 1e-3) {
      auto in = calm(t, Vec3(0, 0, i < 18 ? 2.0 : 0.0));
      in.state.v_W_m_per_s = Vec3(0, 0, 0.4);
      given_J += 1e-3 * last_N * 0.4;
      last_N = s.allow(in).z();
    }
  }
  EXPECT_EQ(s.tripped(), Trip::energy);
  EXPECT_LT(given_J, 0.1 + 0.001);
  EXPECT_GT(given_J, 0.09);
  EXPECT_GT(pulses, 3) << "one pulse alone is no reason";
}

// What the hand put in, it may get back: a spring that is pressed and let go a hundred times, 5 mJ in and out. What the
// sampled wall makes (the force of a step acts with the velocity of the next: 0.25 mJ a press) comes to 12.5 mJ in the
// account's 10 s at five presses a second.
TEST(ForceSupervisor, APassiveWallIsNeverTrippedByItsEnergy) {
  auto l = supervised_limits();
  l.energy_J = 0.02;
  l.slew_N_per_s = 1e6;
  ForceSupervisor s(l);
  double t = 0.0;
  for (int press = 0; press < 100; ++press) {
    // 5 mm into 400 N/m and back within 0.2 s.
    for (int i = 0; i <= 200; ++i, t += 1e-3) {
      const double phase = 3.14159265358979 * i / 200.0;
      auto in = calm(t, Vec3(0, 0, 400.0 * 0.005 * std::sin(phase)));
      in.state.v_W_m_per_s = Vec3(0, 0, -0.005 * 3.14159265358979 / 0.2 * std::cos(phase));
      s.allow(in);
    }
    if (press % 10 == 0) s.rest(t);
  }
  EXPECT_EQ(s.tripped(), Trip::none);
}

TEST(ForceSupervisor, HotMotorsTripWhereTheirTemperatureIsRead) {
  auto l = supervised_limits();
  l.temperature_C = 70.0;
  ForceSupervisor s(l);
  s.allow(calm(0.0));  // not read
  EXPECT_EQ(s.tripped(), Trip::none);
  auto in = calm(0.001);
  in.state.temperature_C = 71.0;
  s.allow(in);
  EXPECT_EQ(s.tripped(), Trip::temperature);
}

TEST(ForceSupervisor, RampIsNeverLongerThanStated) {
  auto s = running();
  s.trip(Trip::asked);
  s.allow(calm(0.101));
  auto during = s;
  EXPECT_GT(during.allow(calm(0.15)).norm(), 0.0);
  EXPECT_EQ(s.allow(calm(0.2011)), Vec3(0, 0, 0));
}

TEST(ForceSupervisor, NoLimitMeansNoForce) {
  ForceSupervisor s(SafetyLimits{});
  for (int i = 0; i < 10; ++i) EXPECT_EQ(s.allow(calm(i * 1e-3)), Vec3(0, 0, 0));
}

}  // namespace
}  // namespace touchstone::hil
