// The OnRobot driver against an emulator that follows the maker's own example. Emulated: it shows that the driver keeps
// to that example, not that a sensor does.
#include "drivers/onrobot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "emulators/onrobot_emulator.h"
#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

Wrench pull_over_time(double t) { return {Vec3(10 + std::sin(t), -2.5, t), Vec3(0.1, -0.02 * t, 0.003)}; }

TEST(OnRobot, ReadsNewtonsAtTheRateThatWasAskedFor) {
  OnRobotEmulator box(pull_over_time);
  const auto source = open_onrobot({"127.0.0.1", box.port(), 4, 0}, 3.0, false);
  EXPECT_EQ(box.filter(), 0);
  EXPECT_TRUE(source->identity().emulated) << "it is on this machine";
  EXPECT_EQ(source->nominal_rate_Hz(), 250.0);
  source->start();
  MonotonicClock clock;
  std::vector<WrenchSample> all, some(64);
  const double until = clock.now_s() + 10.0;
  while (all.size() < 100 && clock.now_s() < until) {
    const auto n = source->read(some, until);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
  }
  source->stop();
  ASSERT_GE(all.size(), 100U);
  EXPECT_EQ(source->counters().lost, 0U);
  for (std::size_t i = 0; i < 100; ++i) {
    const Wrench truth = pull_over_time(4e-3 * static_cast<double>(all[i].sequence));
    EXPECT_LT((all[i].wrench.f_N - truth.f_N).norm(), 1.0e-4) << i;  // a count is 0.1 mN
    EXPECT_LT((all[i].wrench.torque_Nm - truth.torque_Nm).norm(), 1.0e-5) << i;
  }
}

// Its bias is somebody's zero, its filter and period somebody's recording.
TEST(OnRobot, LookingForItChangesNothingOfIt) {
  OnRobotEmulator box(pull_over_time);
  MappedDevice device;
  device.id = onrobot_device.id;
  device.address = "127.0.0.1";
  device.udp_port = box.port();
  EXPECT_THAT(onrobot_device.look(device, 3.0).where, HasSubstr("127.0.0.1"));
  EXPECT_EQ(box.settings(), 0);
  open_onrobot({"127.0.0.1", box.port(), 4, 0}, 3.0, false);
  EXPECT_GE(box.settings(), 3) << "the emulator counts them";
}

TEST(OnRobot, AStreamThatBeganAnewHasNothingOfTheOldOne) {
  OnRobotEmulator box(pull_over_time);
  const auto source = open_onrobot({"127.0.0.1", box.port(), 1, 0}, 3.0, false);
  MonotonicClock clock;
  std::vector<WrenchSample> some(64);
  for (int run = 0; run < 3; ++run) {
    source->start();
    ASSERT_GT(source->read(some, clock.now_s() + 5.0), 0U);
    EXPECT_LT(some[0].sequence, 50U) << run;
    clock.sleep_until(clock.now_s() + 0.1);  // records pile up
    source->stop();
    clock.sleep_until(clock.now_s() + 0.02);
  }
}

TEST(OnRobot, SaysWhenNobodyAnswers) {
  const auto complaint = [](const OnRobotOptions& options) -> std::string {
    try {
      open_onrobot(options, 0.3, false);
    } catch (const DeviceError& error) {
      EXPECT_EQ(error.device_status(), DeviceStatus::absent);
      return error.what();
    } catch (const UsageError& error) {
      return error.what();
    }
    return "opened";
  };
  int port = 0;
  { port = OnRobotEmulator(pull_over_time).port(); }  // it is closed again
  EXPECT_THAT(complaint({"127.0.0.1", port, 2, 0}), HasSubstr("the Compute Box's address"));
  EXPECT_THAT(complaint({"127.0.0.1", port, 0, 0}), HasSubstr("a period of 0 ms"));
  EXPECT_THAT(complaint({"127.0.0.1", port, 2, 7}), HasSubstr("filter 7"));
}

}  // namespace
}  // namespace touchstone::hil
