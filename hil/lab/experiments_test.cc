// Every experiment of the lab against a simulated device in working order, whose numbers it must find, and against one
// with a planted fault, which it must catch. All of it is emulated.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "emulators/simulated_bench.h"
#include "lab/force_experiments.h"
#include "lab/motion_experiments.h"
#include "lab/wall_experiment.h"

namespace touchstone::hil {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

SafetyLimits limits(double force_N = 3.0) {
  SafetyLimits l;
  l.force_N = force_N;
  l.workspace_W_m = Box3(Vec3::Constant(-0.2), Vec3::Constant(0.2));
  return l;
}

Bench bench_of(SimulatedBench& world) {
  Bench bench{world.clock(), world.device()};
  bench.dead_man = &world.dead_man();
  bench.sensor = &world.sensor();
  bench.limits = limits();
  return bench;
}

double sway(double t) { return 0.02 * std::sin(3.0 * t) + 0.004 * std::sin(7.1 * t); }

Finding step_of(const SimulatedFaults& faults) {
  SimulatedBench world(faults);
  auto bench = bench_of(world);
  return force_step(bench, {}, 1.5, Vec3::UnitX());
}
Finding latency_of(const SimulatedFaults& faults) {
  SimulatedBench world(faults);
  auto bench = bench_of(world);
  return force_latency(bench, {}, 1.5, Vec3::UnitY());
}
Finding friction_of(const SimulatedFaults& faults) {
  SimulatedBench world(faults);
  auto bench = bench_of(world);
  world.move_along(sway);
  return friction_by_hand(bench, {}, 20.0);
}
Finding walls_of(const SimulatedFaults& faults) {
  SimulatedBench world(faults);
  auto bench = bench_of(world);
  WallSweep sweep;
  sweep.trial_s = 1.0;
  sweep.prepare = [&world] { world.press_from(0.002); };
  return wall_sweep(bench, {}, sweep);
}
Finding jitter_of(const SimulatedFaults& faults) {
  SimulatedBench world(faults);
  auto bench = bench_of(world);
  return servo_regularity(bench, {}, 5.0, true);
}
// Taps of a spring: half sines.
Finding golden_of(const SimulatedFaults& faults) {
  GoldenForce golden{"taps", {}, {}};
  for (int i = 0; i < 2000; ++i) {
    golden.t_s.push_back(1e-3 * i);
    golden.f_W_N.push_back(4.0 * std::max(0.0, std::sin(2 * std::numbers::pi * 2.5e-3 * i)) * Vec3(0.6, 0, 0.8));
  }
  SimulatedBench world(faults);
  auto bench = bench_of(world);
  return golden_replay(
      bench, {}, golden, [&](std::size_t i) { return golden.f_W_N[i]; }, 2.0);
}

void say(const char* what, const Finding& finding) {
  fmt::print("emulated {:<14} {:<22}", finding.test, what);
  for (const auto& m : finding.measurements) fmt::print(" {}={:.4g}", m.name, m.value);
  fmt::print("\n");
}

TEST(Experiments, AnswersOfADeviceInWorkingOrder) {
  const SimulatedHandle handle;
  const auto step = step_of({});
  say("in order", step);
  EXPECT_THAT(step.failures(), IsEmpty());
  EXPECT_NEAR(step.value("step_measured_N"), 1.5, 0.005);
  EXPECT_NEAR(step.value("step_rise_s"), handle.motor_lag_s * std::log(9.0), 2e-4);
  EXPECT_NEAR(step.value("step_delay_s"), handle.delay_s + handle.motor_lag_s * std::numbers::ln2, 2e-4);

  const auto latency = latency_of({});
  say("in order", latency);
  EXPECT_THAT(latency.failures(), IsEmpty());
  EXPECT_NEAR(latency.value("bandwidth_Hz"), 1 / (2 * std::numbers::pi * handle.motor_lag_s), 8.0);
  EXPECT_NEAR(latency.value("gain_low"), 1.0, 0.02);

  const auto friction = friction_of({});
  say("in order", friction);
  EXPECT_THAT(friction.failures(), IsEmpty());
  EXPECT_NEAR(friction.value("friction_coulomb_N"), handle.friction_N, 0.005);
  EXPECT_NEAR(friction.value("friction_viscous_N_s_per_m"), handle.damping_N_s_per_m, 0.05);
  EXPECT_NEAR(friction.value("felt_mass_kg"), handle.mass_kg, 0.01);

  const auto jitter = jitter_of({});
  say("in order", jitter);
  EXPECT_THAT(jitter.failures(), IsEmpty());
  EXPECT_LT(jitter.value("late_worst_s"), 1e-6);

  const auto golden = golden_of({});
  say("in order", golden);
  EXPECT_THAT(golden.failures(), IsEmpty());
  EXPECT_NEAR(golden.value("force_scale"), 0.5, 1e-4);
  EXPECT_LT(golden.value("force_error_after_lag_N"), 0.5 * golden.value("force_error_rms_N"));
}

// Damping of device and hand bound the stiffness; virtual damping and delay move the bound as Colgate and Schenkel say.
TEST(Experiments, ZWidthFollowsThePassivityBound) {
  const auto in_order = walls_of({});
  say("in order", in_order);
  EXPECT_THAT(in_order.failures(), IsEmpty());
  const double z = in_order.value("z_width_N_per_m");
  // b / (T / 2 + delay + lag) with the grip's damping; passivity is sufficient, Coulomb friction helps.
  const double bound = (0.8 + 0.4) / (0.5e-3 + 0.5e-3 + 1e-3);
  EXPECT_GE(z, bound / std::numbers::sqrt2);
  EXPECT_LE(z, 8 * bound);
  SimulatedFaults slow;
  slow.added_latency_s = 2e-3;
  const auto slower = walls_of(slow);
  say("2 ms more latency", slower);
  EXPECT_LT(slower.value("z_width_N_per_m"), z);
}

struct Planted {
  const char* name;
  SimulatedFaults faults;
  Finding (*experiment)(const SimulatedFaults&);
  const char* caught_by;
};

TEST(Experiments, EachCatchesTheFaultThatItIsThereFor) {
  SimulatedFaults gain, weak, latency, late, lag, friction, jitter;
  gain.force_gain = 1.2;
  weak.force_gain = 0.8;
  latency.added_latency_s = 6e-3;
  late.added_latency_s = 12e-3;
  lag.added_lag_s = 15e-3;
  friction.added_friction_N = 0.6;
  jitter.jitter_s = 0.8e-3;
  const Planted table[] = {
      {"gain 1.2", gain, step_of, "step_error"},
      {"gain 0.8", weak, latency_of, "gain_low"},
      {"gain 1.2", gain, golden_of, "force_error_share"},
      {"latency + 6 ms", latency, latency_of, "latency_s"},
      {"latency + 12 ms", late, step_of, "step_delay_s"},
      {"latency + 6 ms", latency, golden_of, "lag_s"},
      {"latency + 6 ms", latency, walls_of, "z_width_N_per_m"},
      {"lag + 15 ms", lag, step_of, "step_bandwidth_Hz"},
      {"lag + 15 ms", lag, latency_of, "bandwidth_Hz"},
      {"friction + 0.6 N", friction, friction_of, "friction_coulomb_N"},
      {"jitter 0.8 ms", jitter, jitter_of, "late_p99_s"},
  };
  for (const auto& planted : table) {
    SCOPED_TRACE(fmt::format("{} -> {}", planted.name, planted.caught_by));
    const auto finding = planted.experiment(planted.faults);
    say(planted.name, finding);
    EXPECT_THAT(finding.failures(), Contains(HasSubstr(std::string(planted.caught_by) + " is")));
  }
}

TEST(Experiments, AddedLatencyIsMeasuredAsWhatItIs) {
  const double without = latency_of({}).value("latency_s");
  for (const double added : {1e-3, 3e-3, 10e-3}) {
    SimulatedFaults faults;
    faults.added_latency_s = added;
    EXPECT_NEAR(latency_of(faults).value("latency_s") - without, added, 1.5e-4);
  }
}

std::string complaint_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(Experiments, NoForceWithoutADeadManAndNoneAfterItIsLetGo) {
  SimulatedBench world;
  auto bench = bench_of(world);
  bench.dead_man = nullptr;
  EXPECT_THAT(complaint_of([&] { force_step(bench, {}, 1.0, Vec3::UnitX()); }), HasSubstr("without a dead-man input"));
  EXPECT_THAT(complaint_of([&] { force_latency(bench, {}, 1.0, Vec3::UnitX()); }), HasSubstr("without a dead-man"));
  EXPECT_THAT(complaint_of([&] { wall_sweep(bench, {}, {}); }), HasSubstr("without a dead-man"));
  EXPECT_EQ(world.motor_N(), Vec3::Zero());

  SimulatedFaults faults;
  faults.release_at_s = 0.6;
  SimulatedBench released(faults);
  auto held = bench_of(released);
  EXPECT_THAT(complaint_of([&] { force_step(held, {}, 1.0, Vec3::UnitX()); }), HasSubstr("cut short at 0."));
  EXPECT_LT(released.motor_N().norm(), 1e-3 + 1.0);
  released.clock().sleep_until(released.clock().now_s() + 0.1);
  EXPECT_LT(released.motor_N().norm(), 1e-9);
  EXPECT_THAT(complaint_of([&] { force_step(held, {}, 1.0, Vec3::UnitX()); }),
              HasSubstr("nobody took hold within 30 s"));
}

TEST(Experiments, TheForceRampsDownWhenTheDeadManIsLetGo) {
  SimulatedFaults faults;
  faults.release_at_s = 0.5;
  SimulatedBench world(faults);
  auto bench = bench_of(world);
  const auto run = run_servo(bench, 2.0, [](const DeviceState&, double) { return Vec3(1, 0, 0); });
  EXPECT_EQ(run.trip, Trip::dead_man);
  EXPECT_FALSE(run.whole());
  ASSERT_FALSE(run.ticks.empty());
  EXPECT_EQ(run.ticks.back().allowed_N, Vec3::Zero());
  EXPECT_NEAR(run.ticks.back().t_s, 0.5 + bench.limits.ramp_down_s, 0.005);
  double last = 2.0;
  int ramped = 0;
  for (const auto& tick : run.ticks) {
    if (tick.t_s < 0.5) continue;
    EXPECT_LE(tick.allowed_N.x(), last);
    last = tick.allowed_N.x();
    ramped += last > 0.0 && last < 0.99;
  }
  EXPECT_GT(ramped, 50);
}

TEST(Experiments, ADeviceThatGoesAndASensorThatFallsSilentAreErrors) {
  SimulatedFaults unplugged, silent;
  unplugged.unplug_at_s = 0.3;
  silent.sensor_silent_at_s = 0.3;
  EXPECT_THAT(complaint_of([&] { step_of(unplugged); }), HasSubstr("unplugged"));
  EXPECT_THAT(complaint_of([&] { step_of(silent); }), HasSubstr("the sensor gave"));
  EXPECT_THAT(complaint_of([&] {
                SimulatedBench world;
                auto bench = bench_of(world);
                world.move_along([](double t) { return 1e-3 * t; });
                friction_by_hand(bench, {}, 5.0);
              }),
              HasSubstr("0 reversals"));
}

TEST(Finding, HoldsNothingThatIsMissingOrNoNumber) {
  Finding finding{"test", {{"x", 1.0}}, {{"x", 0.0, 2.0}}};
  EXPECT_THAT(finding.failures(), IsEmpty());
  finding.limits.push_back({"y", 0.0, 1.0});
  EXPECT_THAT(finding.failures(), Contains(HasSubstr("y is nan")));
  finding.limits = {{"x", 0.0, 2.0}};
  finding.measurements.push_back({"z", std::nan("")});
  EXPECT_THAT(finding.failures(), Contains(HasSubstr("z could not be measured")));
  EXPECT_THAT(Finding{"test"}.failures(), Not(IsEmpty()));
  EXPECT_THAT(complaint_of([] { lab_limits({{"friction", 1.0}}); }), HasSubstr("known: friction_N"));
  EXPECT_THAT(complaint_of([] { lab_limits({{"friction_N", -1.0}}); }), HasSubstr("not a positive number"));
  EXPECT_EQ(lab_limits({{"friction_N", 0.2}}).friction_N, 0.2);
}

}  // namespace
}  // namespace touchstone::hil
