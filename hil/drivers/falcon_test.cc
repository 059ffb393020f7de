// The Falcon's kinematics and frames, and its driver under unmodified libusb against the USB emulator. The emulator
// encodes our reading of the protocol: results are emulated and prove nothing about a real device.
#include "drivers/falcon.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "drivers/falcon_kinematics.h"
#include "drivers/usb.h"
#include "emulators/permission_denied.h"
#include "emulators/usb_emulator.h"
#include "harness/base/atomic_file.h"
#include "harness/base/random.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

Vec3 reachable(Random& random) {
  return {random.uniform(-0.04, 0.04), random.uniform(-0.04, 0.04), random.uniform(0.09, 0.15)};
}

TEST(FalconMotors, AreScaledTogetherSoThatTheForceKeepsItsDirection) {
  EXPECT_EQ(falcon::motor_counts(Vec3(0.1, -0.2, 0.05), 1e4), (std::array<int, 3>{-1000, 2000, -500}));
  // Twice what a motor takes along the second.
  EXPECT_EQ(falcon::motor_counts(Vec3(0.4095, -0.819, 0.0), 1e4), (std::array<int, 3>{-2048, 4095, 0}));
  EXPECT_EQ(falcon::motor_counts(Vec3(1e300, 0.0, 0.0), 1e4), (std::array<int, 3>{-4095, 0, 0}));
  EXPECT_EQ(falcon::motor_counts(Vec3(1.0, std::nan(""), 0.0), 1e4), (std::array<int, 3>{0, 0, 0}));
}

TEST(FalconKinematics, ForwardUndoesInverse) {
  Random random(3);
  int tried = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = reachable(random);
    const auto angles = falcon::inverse(p);
    if (!angles) continue;
    ++tried;
    const auto back = falcon::forward(*angles, Vec3(0, 0, 0.11));
    ASSERT_TRUE(back) << p.transpose();
    EXPECT_LT((*back - p).norm(), 1e-10);
  }
  EXPECT_GT(tried, 400);
}

TEST(FalconKinematics, JacobianIsTheDerivativeAndTorquesDoTheForcesWork) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = reachable(random);
    const auto angles = falcon::inverse(p);
    if (!angles) continue;
    const Mat3 j = falcon::jacobian(p, *angles);
    constexpr double h = 1e-6;
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = h * Vec3::Unit(k);
      const auto plus = falcon::inverse(p + step), minus = falcon::inverse(p - step);
      ASSERT_TRUE(plus && minus);
      for (int arm = 0; arm < 3; ++arm)
        EXPECT_NEAR(j(arm, k),
                    ((*plus)[static_cast<std::size_t>(arm)] - (*minus)[static_cast<std::size_t>(arm)]) / (2 * h),
                    1e-5 * j.norm());
    }
    // Virtual work: tau . (J dp) = F . dp for every dp.
    const Vec3 f = random.direction(), dp = random.direction();
    EXPECT_NEAR(falcon::motor_torques(p, *angles, f).dot(j * dp), f.dot(dp), 1e-12);
  }
}

// What libnifalcon's FalconKinematicStamper::IK (revision f7c727a) answers, in single precision. Its forces are not
// compared: see falcon_kinematics.h.
TEST(FalconKinematics, AgreesWithLibnifalcon) {
  struct Answer {
    Vec3 p_m;
    std::array<double, 3> angles_rad;
  };
  const Answer answers[] = {
      {{0, 0, 0.12}, {0.4174482, 0.4174482, 0.4174482}},
      {{0.02, -0.01, 0.1}, {0.3864701, -0.1274871, 0.2755369}},
      {{-0.03, 0.02, 0.13}, {0.3461088, 0.9523516, 0.59613}},
      {{0.01, 0.035, 0.15}, {0.621153, 0.9238471, 1.19661}},
      {{-0.02, -0.03, 0.09}, {0.443871, 0.309711, -0.4653296}},
      {{0.04, 0, 0.11}, {0.561958, -0.09320584, 0.7186516}},
  };
  for (const auto& answer : answers) {
    const auto angles = falcon::inverse(answer.p_m);
    ASSERT_TRUE(angles);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((*angles)[i], answer.angles_rad[i], 3e-7) << answer.p_m.transpose();
  }
  EXPECT_NEAR(falcon::angle_of_count(100) * 180 / 3.14159265, 38.6435, 5e-5);
}

TEST(FalconKinematics, OutOfReachIsSaid) {
  EXPECT_FALSE(falcon::inverse(Vec3(0.3, 0, 0.1)));
  EXPECT_FALSE(falcon::inverse(Vec3(0, 0, 0.4)));
  for (const int count : {-3000, 0, 2500}) EXPECT_EQ(falcon::count_of_angle(falcon::angle_of_count(count)), count);
}

TEST(FalconFrames, ComeBack) {
  falcon::Command c;
  c.motors = {-32768, 1, 32767};
  c.homing = true;
  const auto back = falcon::decode_command(falcon::encode(c));
  EXPECT_EQ(back.motors, c.motors);
  EXPECT_TRUE(back.homing);
  falcon::Answer a;
  a.encoders = {-1, 0, 1234};
  a.homed = 5;
  a.buttons = 9;
  auto frame = falcon::encode(a);
  const auto answer = falcon::decode_answer(frame);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->encoders, a.encoders);
  EXPECT_EQ(answer->homed, 5U);
  EXPECT_EQ(answer->buttons, 9U);
  frame[3] = 0x7f;
  EXPECT_FALSE(falcon::decode_answer(frame));
}

class FalconUsb : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!UsbEmulator::preloaded()) GTEST_SKIP() << "needs LD_PRELOAD=libumockdev-preload.so.0 (ctest sets it)";
    const Vec3 p(0.01, -0.02, 0.12);
    const auto angles = falcon::inverse(p);
    position_ = p;
    model_.set_encoders({falcon::count_of_angle((*angles)[0]), falcon::count_of_angle((*angles)[1]),
                         falcon::count_of_angle((*angles)[2])});
    usb_ = std::make_unique<UsbEmulator>(UsbEmulator::Identity{}, model_);
  }
  static DeviceStatus status_of(const std::function<void()>& act) {
    try {
      act();
    } catch (const DeviceError& error) {
      last_message = error.what();
      return error.device_status();
    }
    return DeviceStatus::present;
  }
  std::unique_ptr<HapticDevice> open(const std::string& serial = "") {
    FalconOptions options;
    options.serial = serial;
    options.emulated = true;
    options.timeout_s = 0.5;
    return open_falcon(options);
  }
  static double soon() { return MonotonicClock().now_s() + 0.5; }
  // As the guard does: again until it is confirmed. The driver waits 10 ms for that; on a busy machine how many of them
  // it takes is the scheduler's, of this thread, libusb's and the emulated device's in turn.
  static bool confirms_zero(HapticDevice& device) {
    MonotonicClock clock;
    const double until = clock.now_s() + 30.0;
    bool confirmed = device.zero_force();
    while (!confirmed && clock.now_s() < until) confirmed = device.zero_force();
    return confirmed;
  }

  static inline std::string last_message;
  Vec3 position_;
  FalconModel model_{true};
  std::unique_ptr<UsbEmulator> usb_;
};

TEST_F(FalconUsb, IsSeenWithItsStrings) {
  const UsbContext context;
  const std::uint16_t vendors[] = {0x0403};
  const auto devices = context.devices(vendors);
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices[0].product, 0xcb48);
  EXPECT_EQ(devices[0].product_name, "FALCON HAPTIC");
  EXPECT_EQ(devices[0].serial, "EMUF0001");
  EXPECT_EQ(devices[0].status, DeviceStatus::present);
}

TEST_F(FalconUsb, HomesReportsItsPositionAndPushesAgainstIt) {
  const auto device = open();
  EXPECT_TRUE(device->identity().emulated);
  EXPECT_EQ(device->watchdog_s(), 0.0);
  for (int i = 0; i < 6 && !device->calibrated(); ++i) device->exchange(Vec3(0, 0, 1), soon());
  ASSERT_TRUE(device->calibrated());
  const auto state = device->exchange(Vec3(0, 0, 1), soon());
  EXPECT_LT((state.p_W_m - position_).norm(), 1e-4);  // a count is some 40 um
  const auto motors = model_.motors();
  EXPECT_NE(motors, (std::array<int, 3>{}));
  // The motors' torques do the force's work.
  const auto angles = falcon::inverse(state.p_W_m);
  const Vec3 tau = falcon::motor_torques(state.p_W_m, *angles, Vec3(0, 0, 1));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(motors[i], -10000 * tau[static_cast<int>(i)], 1.5);
  EXPECT_TRUE(confirms_zero(*device));
  EXPECT_EQ(model_.motors(), (std::array<int, 3>{}));
}

// Against firmware that obeys the bit: once homed, every exchange carries the force.
TEST_F(FalconUsb, StaysHomed) {
  const auto device = open();
  for (int i = 0; i < 6 && !device->calibrated(); ++i) device->exchange(Vec3(0, 0, 1), soon());
  ASSERT_TRUE(device->calibrated());
  int with_force = 0;
  for (int i = 0; i < 100; ++i) {
    device->exchange(Vec3(0, 0, 1), soon());
    with_force += model_.motors() != std::array<int, 3>{};
    ASSERT_TRUE(device->calibrated()) << i;
  }
  EXPECT_EQ(with_force, 100);
  ASSERT_TRUE(confirms_zero(*device));
  EXPECT_EQ(model_.motors(), (std::array<int, 3>{}));
  device->exchange(Vec3::Zero(), soon());
  EXPECT_TRUE(device->calibrated()) << "letting go must not lose the reference";
}

TEST_F(FalconUsb, CommandsNothingBeforeItIsHomed) {
  const auto device = open();
  ASSERT_FALSE(device->calibrated());
  device->exchange(Vec3(0, 0, 5), soon());
  EXPECT_EQ(model_.motors(), (std::array<int, 3>{}));
}

TEST_F(FalconUsb, SaysWhyItCannotBeOpened) {
  EXPECT_EQ(status_of([&] { open("OTHER"); }), DeviceStatus::wrong_serial);
  EXPECT_THAT(last_message, HasSubstr("EMUF0001 is there"));
  usb_->faults.busy = true;
  EXPECT_EQ(status_of([&] { open(); }), DeviceStatus::busy);
  const UsbContext context;
  const std::uint16_t vendors[] = {0x0403};
  EXPECT_EQ(context.devices(vendors)[0].status, DeviceStatus::busy);
  usb_->faults.busy = false;
  usb_->faults.stall = true;
  EXPECT_EQ(status_of([&] { open(); }), DeviceStatus::failed);
  usb_->faults.stall = false;
  usb_.reset();
  EXPECT_EQ(status_of([&] { open(); }), DeviceStatus::absent);
}

TEST(FalconUsbPermission, WithoutItTheDriverSaysWhatToDo) {
  if (!UsbEmulator::preloaded()) GTEST_SKIP() << "needs LD_PRELOAD=libumockdev-preload.so.0 (ctest sets it)";
  const auto told = permission_denied();
  EXPECT_EQ(told.status, to_string(DeviceStatus::no_permission));
  EXPECT_THAT(told.message, HasSubstr("udev"));
}

TEST_F(FalconUsb, FaultsWhileRunningAreErrorsWithinTheDeadline) {
  const auto device = open();
  MonotonicClock clock;
  usb_->faults.silent = true;
  double before = clock.now_s();
  EXPECT_EQ(status_of([&] { device->exchange(Vec3::Zero(), clock.now_s() + 0.1); }), DeviceStatus::timed_out);
  EXPECT_GE(clock.now_s(), before + 0.09);
  usb_->faults.silent = false;
  EXPECT_EQ(status_of([&] { device->exchange(Vec3::Zero(), soon()); }), DeviceStatus::present);
  model_.damage_next_frames(1);
  device->exchange(Vec3::Zero(), soon());  // the answer to the exchange that timed out is still in the pipe
  EXPECT_EQ(status_of([&] { device->exchange(Vec3::Zero(), soon()); }), DeviceStatus::failed);
  usb_->faults.stall = true;
  EXPECT_EQ(status_of([&] { device->exchange(Vec3::Zero(), soon()); }), DeviceStatus::failed);
  EXPECT_THAT(last_message, HasSubstr("stall"));
  usb_->faults.stall = false;
}

TEST_F(FalconUsb, ShortPacketsTimeOutInsteadOfBecomingPositions) {
  const auto device = open();
  usb_->faults.short_packets = true;
  EXPECT_NE(status_of([&] { device->exchange(Vec3::Zero(), MonotonicClock().now_s() + 0.1); }), DeviceStatus::present);
}

TEST_F(FalconUsb, UnpluggedIsGone) {
  const auto device = open();
  usb_->faults.gone = true;
  EXPECT_EQ(status_of([&] { device->exchange(Vec3::Zero(), soon()); }), DeviceStatus::gone);
  EXPECT_FALSE(device->zero_force());
}

TEST_F(FalconUsb, FirmwareIsUploadedWithEveryByteChecked) {
  usb_.reset();
  FalconModel bare(false, 1037);
  bare.set_encoders({100, 200, 300});
  UsbEmulator usb(UsbEmulator::Identity{}, bare);
  const auto file = std::filesystem::temp_directory_path() / fmt::format("touchstone-firmware-{}", ::getpid());
  write_file(file, std::string(1000, 'f') + std::string(37, 'g'));
  FalconOptions options;
  options.emulated = true;
  options.timeout_s = 0.5;
  EXPECT_EQ(status_of([&] { open_falcon(options); }), DeviceStatus::failed);
  EXPECT_THAT(last_message, HasSubstr("no firmware is running"));
  options.firmware = file;
  bare.damage_echo();
  EXPECT_EQ(status_of([&] { open_falcon(options); }), DeviceStatus::failed);
  EXPECT_THAT(last_message, HasSubstr("echo of the firmware differs"));
  const auto device = open_falcon(options);
  EXPECT_EQ(bare.firmware_bytes(), 1037U);
  device->exchange(Vec3::Zero(), soon());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace touchstone::hil
