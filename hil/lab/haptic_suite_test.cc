// The lab's tests of haptic devices. Procedures and pictures: docs/how-to/lab.md.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "emulators/haptic_emulator.h"
#include "harness/golden/case_runner.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "harness/surface/embree_surface.h"
#include "lab/analysis.h"
#include "lab/force_experiments.h"
#include "lab/motion_experiments.h"
#include "lab/suite.h"
#include "lab/wall_experiment.h"
#include "renderers/catalogue.h"
#include "safety/guardian.h"
#include "synthetic/generators.h"

namespace touchstone::hil {
namespace {

class Haptic : public ::testing::TestWithParam<const char*> {};

TEST_P(Haptic, ServoJitter) {
  TOUCHSTONE_REQUIRE_DEVICE(found, GetParam());
  LabStation station(GetParam(), found, false, false);
  // Limits are held only where the run was scheduled for it.
  const bool scheduled = found.emulated || scheduling() != "SCHED_OTHER";
  station.conclude(servo_regularity(station.bench(), station.limits(), found.emulated ? 5.0 : 60.0, scheduled));
}

TEST_P(Haptic, FrictionByHand) {
  const auto found = availability_for(GetParam(), Needs::person);
  TOUCHSTONE_JUDGE(found);
  LabStation station(GetParam(), found, false, true);
  if (station.emulated())
    station.simulated()->move_along([](double t) { return 0.02 * std::sin(3.0 * t) + 0.004 * std::sin(7.1 * t); });
  station.conclude(friction_by_hand(station.bench(), station.limits(), 30.0));
}

TEST_P(Haptic, ForceStep) {
  const auto found = availability_for(GetParam(), Needs::forces);
  TOUCHSTONE_JUDGE(found);
  LabStation station(GetParam(), found, true, true);
  station.conclude(force_step(station.bench(), station.limits(), 0.5 * station.force_limit_N(), Vec3::UnitX()));
}

TEST_P(Haptic, LatencyAndBandwidth) {
  const auto found = availability_for(GetParam(), Needs::forces);
  TOUCHSTONE_JUDGE(found);
  LabStation station(GetParam(), found, true, true);
  station.conclude(force_latency(station.bench(), station.limits(), 0.5 * station.force_limit_N(), Vec3::UnitX()));
}

TEST_P(Haptic, WallSweep) {
  const auto found = availability_for(GetParam(), Needs::forces);
  TOUCHSTONE_JUDGE(found);
  LabStation station(GetParam(), found, true, false);
  WallSweep sweep;
  if (station.emulated()) {
    sweep.trial_s = 1.0;
    sweep.prepare = [&station] { station.simulated()->press_from(0.002); };
  } else {
    sweep.prepare = [] {
      fmt::print(stderr, "--> lift the handle off the wall (x > 0), then press again; 3 s\n");
      ::sleep(3);
    };
  }
  station.conclude(wall_sweep(station.bench(), station.limits(), sweep));
}

TEST_P(Haptic, GoldenReplay) {
  const auto found = availability_for(GetParam(), Needs::forces);
  TOUCHSTONE_JUDGE(found);
  LabStation station(GetParam(), found, true, true);  // forks: before the renderer's threads
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  ASSERT_NE(source, nullptr) << "TOUCHSTONE_SOURCE_DIR says where the folder golden is (ctest sets it)";
  const auto golden = golden::load_case(std::filesystem::path(source) / "golden" / "bowl-push");
  const std::string model = "god-object";
  ASSERT_EQ(golden.models.count(model), 1U);
  const auto expected = recording::load_rendered(golden.expected(model));
  const auto trajectory = golden::case_trajectory(synthetic::built_in_generators(), golden);
  ASSERT_EQ(trajectory.size(), expected.size());
  const auto renderer =
      renderers::make_renderer(rendering::parse_model(golden.models.at(model), "case.json"),
                               make_embree_surface(golden::case_mesh(synthetic::built_in_generators(), golden)));
  renderer->reset();
  const auto render = [&](std::size_t i) -> Vec3 {
    rendering::TipState tip;
    tip.t_s = trajectory.motion.t_s[i];
    tip.p_W_m = trajectory.motion.p_W_m[i];
    if (!trajectory.motion.q_WS.empty()) tip.q_WS = trajectory.motion.q_WS[i];
    return renderer->step(tip).f_W_N;
  };
  station.conclude(golden_replay(station.bench(), station.limits(), {golden.name, expected.t_s, expected.f_W_N}, render,
                                 0.8 * station.force_limit_N()));
}

// Through the guardian, in real time: on hardware with the device, else with one in shared memory.
TEST_P(Haptic, LetsGoWhenTheProgramStops) {
  const auto found = availability_for(GetParam(), Needs::forces);
  TOUCHSTONE_JUDGE(found);
  LabStation station(GetParam(), found, true, false);
  const auto half = [&](const DeviceState&, double) -> Vec3 { return 0.5 * station.force_limit_N() * Vec3::UnitX(); };
  if (!found.emulated) {
    run_servo(station.bench(), 0.1, half);
    EXPECT_TRUE(station.bench().device.zero_force());
    return;
  }
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("touchstone-lab-{}-{}", ::getpid(), GetParam());
  const EmulatedHapticPlant plant(file, 0.0);
  GuardOptions options;
  options.limits = station.bench().limits;
  options.limits.stale_s = options.driver_timeout_s = options.watchdog_s = 5.0;
  const auto device = open_guarded([&] { return open_emulated_haptic(file); }, options);
  MonotonicClock clock;
  Bench bench{clock, *device};
  bench.dead_man = station.bench().dead_man;
  bench.limits = station.bench().limits;
  bench.patience_s = bench.limits.stale_s = 5.0;  // an emulator on a busy machine may be late without any harm
  double pushed_N = 0.0;
  bench.stop = [&] { return pushed_N > 0.5; };
  run_servo(bench, 5.0, [&](const DeviceState& state, double t) {
    pushed_N = std::max(pushed_N, plant.applied_N().norm());
    return half(state, t);
  });
  EXPECT_GT(pushed_N, 0.5);
  EXPECT_EQ(plant.applied_N(), Vec3(0, 0, 0));
}

INSTANTIATE_TEST_SUITE_P(Lab, Haptic, ::testing::Values("novint-falcon", "force-dimension-omega", "3ds-touch"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

}  // namespace
}  // namespace touchstone::hil
