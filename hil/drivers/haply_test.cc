// The Haply driver against an emulator that keeps to Haply's published protocol. Emulated: it shows that the driver
// keeps to it, too, not that an Inverse3 does.
#include "drivers/haply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "emulators/haply_emulator.h"
#include "safety/guardian.h"

namespace touchstone::hil {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Vec3 ring(double t) { return {0.05 * std::cos(t), 0.05 * std::sin(t), 0.15}; }

// By Haply's page "Control Commands" (3.5), and as published clients of earlier services send.
TEST(Haply, CommandsAreAsDocumented) {
  for (const auto& [key, name] : {std::pair(haply::ForceKey::vector, "vector"), {haply::ForceKey::values, "values"}}) {
    nlohmann::json expected =
        nlohmann::json::parse(R"({"inverse3": [{"device_id": "049D", "commands": {"set_cursor_force": {}}}]})");
    expected["inverse3"][0]["commands"]["set_cursor_force"][name] = {{"x", 1.0}, {"y", -2.0}, {"z", 0.5}};
    EXPECT_EQ(nlohmann::json::parse(haply::force_command("049D", {1, -2, 0.5}, key)), expected);
  }
}

TEST(Haply, AnOlderServiceGetsTheForceUnderItsOwnName) {
  HaplyFaults old;
  old.before_3_5 = true;
  HaplyEmulator service(old, ring);
  const auto device = open_haply({"127.0.0.1", service.port(), "", 3.0});
  device->exchange({1.5, -0.5, 0.25}, MonotonicClock().now_s() + 2.0);
  EXPECT_EQ(service.applied_N(), Vec3(1.5, -0.5, 0.25));
  EXPECT_TRUE(device->zero_force());
  EXPECT_EQ(service.applied_N(), Vec3::Zero());
}

// The service answers also what it does not obey.
TEST(Haply, AnAnswerAloneDoesNotConfirmZero) {
  HaplyFaults faults;
  faults.ignores_commands = true;
  faults.force_before_N = 2.0;
  HaplyEmulator service(faults, ring);
  const auto device = open_haply({"127.0.0.1", service.port(), "", 3.0});
  EXPECT_NO_THROW(device->exchange(Vec3::Zero(), MonotonicClock().now_s() + 2.0));
  EXPECT_FALSE(device->zero_force());
}

TEST(Haply, OtherAxesAndScalesAreRefused) {
  const auto complaint = [](const HaplyFaults& faults) -> std::string {
    HaplyEmulator service(faults, ring);
    try {
      open_haply({"127.0.0.1", service.port(), "", 3.0});
    } catch (const DeviceError& error) {
      return error.what();
    }
    return "opened";
  };
  HaplyFaults faults;
  faults.mount_scale = 2.0;
  EXPECT_THAT(complaint(faults), AllOf(HasSubstr("/config/mount/scale"), HasSubstr("Haply Hub")));
  faults = {};
  faults.axes = "XZY";
  EXPECT_THAT(complaint(faults), AllOf(HasSubstr("XZY"), HasSubstr("Haply Hub")));
}

// Who only looks whether it is there sends nothing into another program's session.
TEST(Haply, OpeningAndClosingCommandsNothing) {
  HaplyEmulator service({}, ring);
  open_haply({"127.0.0.1", service.port(), "", 3.0});
  EXPECT_EQ(service.messages(), 0U);
}

TEST(Haply, ForcesGoOutAndStatesComeBackOneForOne) {
  HaplyEmulator service({}, ring);
  const auto device = open_haply({"127.0.0.1", service.port(), "", 3.0});
  EXPECT_EQ(device->identity().serial, "049D");
  EXPECT_TRUE(device->identity().emulated);
  EXPECT_TRUE(device->calibrated());
  MonotonicClock clock;
  for (int i = 0; i < 200; ++i) {
    const Vec3 force(0.01 * i, -0.5, 0.25);
    const auto state = device->exchange(force, clock.now_s() + 2.0);
    EXPECT_NEAR(state.p_W_m.head<2>().norm(), 0.05, 1e-6);
    EXPECT_NEAR(state.v_W_m_per_s.norm(), 0.05, 1e-3);
    EXPECT_EQ(state.buttons, 2U);
    EXPECT_EQ(service.applied_N(), force);
  }
  EXPECT_EQ(service.messages(), 200U);
  EXPECT_TRUE(device->zero_force());
  EXPECT_EQ(service.applied_N(), Vec3::Zero());
}

TEST(Haply, ClosingLetsGo) {
  HaplyEmulator service({}, ring);
  {
    const auto device = open_haply({"127.0.0.1", service.port(), "049D", 3.0});
    device->exchange({3, 0, 0}, MonotonicClock().now_s() + 2.0);
    EXPECT_EQ(service.applied_N().x(), 3.0);
  }
  EXPECT_EQ(service.applied_N(), Vec3::Zero());
}

TEST(Haply, WithoutCalibrationOrAWordOfItThereIsNoForce) {
  HaplyFaults faults;
  faults.not_calibrated = true;
  HaplyEmulator first(faults, ring);
  EXPECT_FALSE(open_haply({"127.0.0.1", first.port(), "", 3.0})->calibrated());
  faults = {};
  faults.no_status = true;
  HaplyEmulator second(faults, ring);
  EXPECT_FALSE(open_haply({"127.0.0.1", second.port(), "", 3.0})->calibrated());
}

TEST(Haply, EveryFaultIsSaidInTime) {
  const auto complaint = [](HaplyFaults faults, const std::string& serial = "") -> std::string {
    HaplyEmulator service(faults, ring);
    MonotonicClock clock;
    const double began = clock.now_s();
    std::string said = "nothing";
    try {
      const auto device = open_haply({"127.0.0.1", service.port(), serial, 2.0});
      for (int i = 0; i < 20; ++i) device->exchange(Vec3::Zero(), clock.now_s() + 0.5);
    } catch (const DeviceError& error) {
      said = error.what();
    }
    EXPECT_LT(clock.now_s() - began, 10.0);
    return said;
  };
  HaplyFaults faults;
  EXPECT_THAT(complaint(faults, "1234"), HasSubstr("has 049D; the hardware map wants 1234"));
  faults.no_device = true;
  EXPECT_THAT(complaint(faults), HasSubstr("sees no Inverse3"));
  faults = {};
  faults.strange_inventory = true;
  EXPECT_THAT(complaint(faults), HasSubstr("inventory is not as documented"));
  faults = {};
  faults.silent_after = 5;
  EXPECT_THAT(complaint(faults), HasSubstr("no answer in time"));
  faults = {};
  faults.garbage_at = 5;
  EXPECT_THAT(complaint(faults), HasSubstr("no JSON"));
  faults = {};
  faults.gone_after = 5;
  EXPECT_THAT(complaint(faults), HasSubstr("does not list it any more"));
  int port = 0;
  { port = HaplyEmulator({}, ring).port(); }
  try {
    open_haply({"127.0.0.1", port, "", 1.0});
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.device_status(), DeviceStatus::absent);
    EXPECT_THAT(error.what(), HasSubstr("Inverse service"));
  }
}

// After an answer that did not come the next one would be an old one: the connection is given up.
TEST(Haply, AfterATimeoutNothingOldIsTakenForNew) {
  HaplyFaults faults;
  faults.silent_after = 1;
  HaplyEmulator service(faults, ring);
  const auto device = open_haply({"127.0.0.1", service.port(), "", 3.0});
  MonotonicClock clock;
  EXPECT_THROW(device->exchange({1, 0, 0}, clock.now_s() + 0.1), DeviceError);
  EXPECT_THROW(device->exchange({1, 0, 0}, clock.now_s() + 0.1), DeviceError);
  EXPECT_FALSE(device->zero_force());
}

}  // namespace
}  // namespace touchstone::hil
