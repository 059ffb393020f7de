// A device that is a plug-in in C: the one of examples/c-device, and others that each do one thing wrong.
#include "drivers/plugin_device.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "safety/guardian.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

std::filesystem::path misbehaving(const std::string& how) {
  return std::filesystem::path(TOUCHSTONE_MISBEHAVING_DEVICES) / (how + ".so");
}
const std::filesystem::path example = TOUCHSTONE_EXAMPLE_DEVICE;

std::string complaint(const std::filesystem::path& library, const std::string& settings, DeviceStatus status) {
  try {
    open_plugin_device(library, settings);
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.device_status(), status);
    return error.what();
  }
  return "opened";
}

GuardOptions patient() {
  GuardOptions options;
  options.limits.force_N = 3.0;
  options.limits.slew_N_per_s = 1e5;
  options.limits.workspace_W_m = Box3(Vec3::Constant(-0.1), Vec3::Constant(0.1));
  // Long patience: a busy machine is not what is tried here.
  options.limits.stale_s = options.driver_timeout_s = options.watchdog_s = 2.0;
  return options;
}

// Pushes +x with 2 N at 1 kHz; returns what ended it, or nothing after `seconds`.
std::string push(GuardedDevice& device, double seconds) {
  MonotonicClock clock;
  try {
    const double start = clock.now_s();
    for (double t = start; t < start + seconds; t += 1e-3) {
      clock.sleep_until(t);
      device.exchange(Vec3(2, 0, 0), clock.now_s() + 5.0);
    }
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "";
}

TEST(PluginDevice, TheExampleMovesAndTakesForce) {
  const auto device = open_plugin_device(example, "press");
  EXPECT_EQ(device->identity().id, "emulated-handle");
  EXPECT_EQ(device->identity().serial, "PRESS");
  EXPECT_TRUE(device->identity().emulated);
  EXPECT_TRUE(device->calibrated());
  MonotonicClock clock;
  const double before = clock.now_s();
  const DeviceState first = device->exchange(Vec3(0, 0, 3.0), clock.now_s() + 0.1);
  EXPECT_GE(first.t_s, before);
  EXPECT_TRUE(std::isnan(first.temperature_C));
  clock.sleep_until(clock.now_s() + 0.3);
  const DeviceState pushed = device->exchange(Vec3::Zero(), clock.now_s() + 0.1);
  // 3 N against 300 N/m: up by 10 mm within the 4 mm that the hand moves; a tenth of a second is integrated.
  EXPECT_GT(pushed.p_W_m.z(), 0.004);
  EXPECT_TRUE(device->zero_force());
}

TEST(PluginDevice, SaysWhyItIsNotOpened) {
  EXPECT_THAT(complaint("/nowhere/libnone.so", "", DeviceStatus::no_driver), HasSubstr("touchstone/device.h"));
  EXPECT_THAT(complaint(misbehaving("FOLLOWS_ANOTHER_VERSION"), "", DeviceStatus::no_driver),
              HasSubstr("version 1 of the device interface (it has 2)"));
  EXPECT_THAT(complaint(misbehaving("LACKS_ZERO_FORCE"), "", DeviceStatus::no_driver), HasSubstr("zero_force is NULL"));
  EXPECT_THAT(complaint(misbehaving("OPENS_NOTHING_AND_IS_SILENT"), "", DeviceStatus::failed),
              HasSubstr("did not say why"));
  EXPECT_THAT(complaint(example, "jump", DeviceStatus::failed), HasSubstr("\"press\" or \"slide\""));
}

TEST(PluginDevice, WhateverItDoesTheGuardLetsGo) {
  const struct {
    const char* how;
    Trip reason;
  } wrongs[] = {{"CRASHES_IN_EXCHANGE", Trip::driver_gone},
                {"FAILS_IN_EXCHANGE", Trip::device_error},
                {"RETURNS_NAN", Trip::not_finite}};
  for (const auto& wrong : wrongs) {
    SCOPED_TRACE(wrong.how);
    const auto library = misbehaving(wrong.how);
    const auto device = open_guarded([&] { return open_plugin_device(library, ""); }, patient());
    EXPECT_NE(push(*device, 5.0), "");
    EXPECT_EQ(device->tripped(), wrong.reason);
  }
}

TEST(PluginDevice, ASecondGuardOfTheSameDeviceIsRefused) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("touchstone-two-guards-{}", ::getpid());
  ::setenv("TOUCHSTONE_LOCK_DIR", folder.c_str(), 1);
  const auto open = [] { return open_plugin_device(example, "press"); };
  {
    const auto first = open_guarded(open, patient());
    try {
      const auto second = open_guarded(open, patient());
      FAIL() << "two programs command one device";
    } catch (const DeviceError& error) {
      EXPECT_EQ(error.device_status(), DeviceStatus::busy);
      EXPECT_THAT(error.what(), HasSubstr(fmt::format("process {}", ::getpid())));
    }
    EXPECT_EQ(push(*first, 0.05), "") << "the first is not disturbed";
  }
  EXPECT_NO_THROW(open_guarded(open, patient()));
  std::filesystem::remove_all(folder);
  ::unsetenv("TOUCHSTONE_LOCK_DIR");
}

TEST(PluginDevice, LimitsThatAreNoFiniteNumbersAreRefused) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  GuardOptions endless = patient();
  endless.limits.stale_s = infinite;
  EXPECT_THROW(open_guarded([] { return open_plugin_device(example, ""); }, endless), UsageError);
  GuardOptions strong = patient();
  strong.limits.force_N = infinite;
  EXPECT_THROW(open_guarded([] { return open_plugin_device(example, ""); }, strong), UsageError);
}

// With the limits that are on unless somebody changes them.
TEST(PluginDevice, ADeviceThatRunsAwayIsStoppedByItsEnergy) {
  const auto library = misbehaving("RUNS_AWAY");
  const auto device = open_guarded([&] { return open_plugin_device(library, ""); }, patient());
  EXPECT_THAT(push(*device, 5.0), HasSubstr("energy"));
  EXPECT_EQ(device->tripped(), Trip::energy);
  // 2 N at 0.9 m/s give 0.1 J within 56 ms: the force was on for not much longer.
  double began = 0.0, ended = 0.0;
  for (const auto& event : device->events()) {
    if (event.phase == GuardPhase::pushing) began = event.t_s;
    if (event.phase == GuardPhase::letting_go) ended = event.t_s;
  }
  EXPECT_GT(ended, began + 0.02);
  EXPECT_LT(ended, began + 1.0);
}

}  // namespace
}  // namespace touchstone::hil
