// Drivers that go through a library opened at run time, against stub libraries: comedi, Force Dimension, 3D Systems.
// They show that the calls come in the right order with the right units, nothing about real devices.
#include <dlfcn.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <vector>

#include "drivers/comedi_daq.h"
#include "drivers/device_table.h"
#include "drivers/vendor_devices.h"
#include "emulators/ati_calibration_for_test.h"
#include "harness/base/atomic_file.h"
#include "record/stream.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

std::string last_message;
DeviceStatus status_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const DeviceError& error) {
    last_message = error.what();
    return error.device_status();
  }
  return DeviceStatus::present;
}

class ComediStub : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::temp_directory_path() / fmt::format("touchstone-comedi-{}.cal", ::getpid());
    write_file(file_, ati_calibration_for_test());
    options_.library = TOUCHSTONE_STUB_COMEDI;
    options_.calibration_file = file_;
    options_.emulated = true;
    ::setenv("TOUCHSTONE_STUB_COMEDI_VOLTS", "0.5 -1 2 3 4 5", 1);
  }
  void TearDown() override {
    ::unsetenv("TOUCHSTONE_STUB_COMEDI_FAULT");
    std::filesystem::remove(file_);
  }
  std::filesystem::path file_;
  ComediOptions options_;
  MonotonicClock clock_;
};

TEST_F(ComediStub, VoltagesBecomeWrenchesWithoutTheirBias) {
  const auto source = open_comedi_ati(options_);
  EXPECT_EQ(source->identity().serial, "FT9");
  EXPECT_THAT(source->identity().calibration, HasSubstr(".cal"));
  source->start();
  std::vector<WrenchSample> samples(500);
  const double deadline = clock_.now_s() + 5.0;
  Wrench last;
  std::uint64_t n = 0;
  while (n < 4000) {
    const auto got = source->read(samples, deadline);
    ASSERT_GT(got, 0U);
    EXPECT_EQ(samples[0].sequence, n);
    n += got;
    last = samples[got - 1].wrench;
  }
  const double step = 2.0 * 20.0 / 65535;  // a count, in N
  EXPECT_LT((last.f_N - Vec3(1, -2, 4)).cwiseAbs().maxCoeff(), step);
  EXPECT_LT((last.torque_Nm - 1e-3 * Vec3(6, 8, 10)).cwiseAbs().maxCoeff(), 1e-3 * step);
  EXPECT_EQ(source->counters().received, n);
}

// 3 % of 5 V are 0.3 N with a gauge of 2 N per volt.
TEST_F(ComediStub, ACardThatCalibratesInSoftwareNeedsItsFile) {
  EXPECT_THAT(open_comedi_ati(options_)->identity().calibration, HasSubstr("card calibrated in hardware"));
  const auto polynomials = std::filesystem::temp_directory_path() / fmt::format("touchstone-ni-{}", ::getpid());
  ::setenv("TOUCHSTONE_STUB_COMEDI_SOFTCAL", polynomials.c_str(), 1);
  EXPECT_EQ(status_of([&] { open_comedi_ati(options_); }), DeviceStatus::failed);
  EXPECT_THAT(last_message, HasSubstr("calibrates in software"));
  write_file(polynomials, "as comedi_soft_calibrate makes it\n");
  const auto source = open_comedi_ati(options_);
  EXPECT_THAT(source->identity().calibration,
              HasSubstr("card calibrated in software by " + polynomials.filename().string()));
  source->start();
  std::vector<WrenchSample> samples(500);
  Wrench last;
  for (std::size_t n = 0; n < 4000;) {
    const auto got = source->read(samples, clock_.now_s() + 5.0);
    ASSERT_GT(got, 0U);
    n += got;
    last = samples[got - 1].wrench;
  }
  ::unsetenv("TOUCHSTONE_STUB_COMEDI_SOFTCAL");
  std::filesystem::remove(polynomials);
  EXPECT_LT((last.f_N - Vec3(1, -2, 4)).cwiseAbs().maxCoeff(), 2.0 * 20.0 / 65535);
}

TEST_F(ComediStub, EveryFaultHasItsWord) {
  const std::pair<const char*, DeviceStatus> cases[] = {{"absent", DeviceStatus::absent},
                                                        {"forbidden", DeviceStatus::no_permission},
                                                        {"busy", DeviceStatus::busy},
                                                        {"no-range", DeviceStatus::failed}};
  for (const auto& [fault, expected] : cases) {
    ::setenv("TOUCHSTONE_STUB_COMEDI_FAULT", fault, 1);
    EXPECT_EQ(status_of([&] { open_comedi_ati(options_); }), expected) << fault;
  }
  ::unsetenv("TOUCHSTONE_STUB_COMEDI_FAULT");
  options_.library = "/nowhere/libcomedi.so.0";
  EXPECT_EQ(status_of([&] { open_comedi_ati(options_); }), DeviceStatus::no_driver);
  EXPECT_THAT(last_message, HasSubstr("/nowhere/libcomedi.so.0"));
}

TEST_F(ComediStub, AStreamThatEndsIsGone) {
  ::setenv("TOUCHSTONE_STUB_COMEDI_FAULT", "unplug", 1);
  const auto source = open_comedi_ati(options_);
  source->start();
  std::vector<WrenchSample> samples(100);
  EXPECT_EQ(status_of([&] {
              while (source->read(samples, clock_.now_s() + 2.0) > 0) {
              }
            }),
            DeviceStatus::gone);
}

class VendorStub : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.library = TOUCHSTONE_STUB_VENDOR;
    options_.emulated = true;
    stub_ = ::dlopen(TOUCHSTONE_STUB_VENDOR, RTLD_NOW);
    ASSERT_NE(stub_, nullptr);
  }
  void TearDown() override {
    fault("");
    ::dlclose(stub_);
  }
  Vec3 applied() const {
    Vec3 f;
    reinterpret_cast<void (*)(double*)>(::dlsym(stub_, "touchstone_stub_force"))(f.data());
    return f;
  }
  void fault(const char* name) const {
    reinterpret_cast<void (*)(const char*)>(::dlsym(stub_, "touchstone_stub_fault"))(name);
  }
  void* stub_ = nullptr;
  VendorDeviceOptions options_;
  MonotonicClock clock_;
};

TEST_F(VendorStub, ForceDimensionSetsItsWatchdogAndSpeaksSi) {
  {
    const auto device = open_force_dimension(options_);
    EXPECT_EQ(device->identity().serial, "4711");
    EXPECT_NEAR(device->watchdog_s(), 0.02, 1e-12);
    EXPECT_EQ(reinterpret_cast<int (*)()>(::dlsym(stub_, "touchstone_stub_watchdog_periods"))(), 160);
    const auto state = device->exchange(Vec3(1, 2, 3), clock_.now_s() + 1);
    EXPECT_EQ(state.p_W_m, Vec3(0.01, 0.02, 0.03));
    EXPECT_EQ(applied(), Vec3(1, 2, 3));
    fault("fails");
    EXPECT_EQ(status_of([&] { device->exchange(Vec3(1, 2, 3), clock_.now_s() + 1); }), DeviceStatus::failed);
    EXPECT_FALSE(device->zero_force());
    fault("");
  }
  EXPECT_EQ(applied(), Vec3(0, 0, 0));  // closing leaves it at zero
  options_.serial = "1";
  EXPECT_EQ(status_of([&] { open_force_dimension(options_); }), DeviceStatus::wrong_serial);
  fault("absent");
  EXPECT_EQ(status_of([&] { open_force_dimension(options_); }), DeviceStatus::absent);
}

TEST_F(VendorStub, ForceDimensionIsNotCalibratedBeforeItsReset) {
  const auto reset_done = reinterpret_cast<void (*)(int)>(::dlsym(stub_, "touchstone_stub_reset_done"));
  reset_done(0);
  const auto device = open_force_dimension(options_);
  EXPECT_FALSE(device->calibrated());
  device->exchange(Vec3(1, 2, 3), clock_.now_s() + 1);
  EXPECT_FALSE(device->calibrated());
  EXPECT_EQ(applied(), Vec3(0, 0, 0));  // nothing is commanded in an arbitrary direction
  reset_done(1);
  device->exchange(Vec3::Zero(), clock_.now_s() + 1);
  EXPECT_TRUE(device->calibrated());
  device->exchange(Vec3(1, 2, 3), clock_.now_s() + 1);
  EXPECT_EQ(applied(), Vec3(1, 2, 3));
}

TEST_F(VendorStub, OpenHapticsConvertsMillimetresAndHasADeadline) {
  {
    const auto device = open_openhaptics(options_);
    EXPECT_EQ(device->identity().serial, "STUB-4712");
    const auto state = device->exchange(Vec3(0, 0, 2), clock_.now_s() + 1);
    EXPECT_LT((state.p_W_m - Vec3(0.01, 0.02, 0.03)).norm(), 1e-15);
    EXPECT_LT((state.v_W_m_per_s - Vec3(0.1, 0, 0)).norm(), 1e-15);
    EXPECT_EQ(state.buttons, 3U);
    EXPECT_EQ(applied(), Vec3(0, 0, 2));
    EXPECT_TRUE(device->calibrated());
    fault("fails");  // the servo thread stops ticking
    EXPECT_EQ(status_of([&] { device->exchange(Vec3(0, 0, 2), clock_.now_s() + 0.05); }), DeviceStatus::timed_out);
    fault("");
  }
  fault("absent");
  EXPECT_EQ(status_of([&] { open_openhaptics(options_); }), DeviceStatus::absent);
}

// A servo thread that does not tick holds the force: neither zero nor motors off is confirmed then.
TEST_F(VendorStub, OpenHapticsConfirmsZeroByATickOnly) {
  const auto forces_on = reinterpret_cast<int (*)()>(::dlsym(stub_, "touchstone_stub_forces_on"));
  const auto device = open_openhaptics(options_);
  device->exchange(Vec3(0, 0, 2), clock_.now_s() + 1);
  fault("fails");
  // A tick that had begun may still end: after it there is none.
  while (device->zero_force()) {
  }
  EXPECT_FALSE(device->motors_off());
  EXPECT_EQ(forces_on(), 0) << "force output is switched off all the same";
  fault("");
  // On a busy machine the next tick may begin later than zero_force() waits for it: asked again, it is confirmed.
  bool confirmed = false;
  for (int asked = 0; asked < 10'000 && !confirmed; ++asked) confirmed = device->motors_off();
  EXPECT_TRUE(confirmed);
  EXPECT_EQ(applied(), Vec3(0, 0, 0));
}

TEST_F(VendorStub, OpenHapticsUpdatesItsCalibration) {
  fault("uncalibrated");
  const auto device = open_openhaptics(options_);
  device->exchange(Vec3::Zero(), clock_.now_s() + 1);
  device->exchange(Vec3::Zero(), clock_.now_s() + 1);
  EXPECT_TRUE(device->calibrated());
}

// Its stylus out of the inkwell: nothing is updated and nothing commanded, and a recording says that its places mean
// nothing. Put back, the device asks for the update.
TEST_F(VendorStub, OpenHapticsWaitsForTheInkwell) {
  fault("out of inkwell");
  auto device = open_openhaptics(options_);
  device->exchange(Vec3::Zero(), clock_.now_s() + 1);
  EXPECT_FALSE(device->calibrated());
  EXPECT_THAT(calibrating_text(device->identity().id), HasSubstr("inkwell"));
  const auto stream = stream_of(std::move(device), 1000.0);
  stream->start();
  std::vector<RawSample> sample(1);
  ASSERT_EQ(stream->read(sample, clock_.now_s() + 1), 1U);
  EXPECT_NE(sample[0].wrench.flags & recording::sample_not_tracked, 0U);
  fault("uncalibrated");
  for (int i = 0; i < 3; ++i) ASSERT_EQ(stream->read(sample, clock_.now_s() + 1), 1U);
  EXPECT_EQ(sample[0].wrench.flags & recording::sample_not_tracked, 0U);
}

TEST_F(VendorStub, AMissingLibraryIsSaidWithWhatToDo) {
  options_.library = "/nowhere/libdhd.so";
  EXPECT_EQ(status_of([&] { open_force_dimension(options_); }), DeviceStatus::no_driver);
  EXPECT_THAT(last_message, HasSubstr("hardware map"));
  options_.library = TOUCHSTONE_STUB_COMEDI;  // a library, but another one
  EXPECT_EQ(status_of([&] { open_openhaptics(options_); }), DeviceStatus::no_driver);
  EXPECT_THAT(last_message, HasSubstr("hdInitDevice"));
}

}  // namespace
}  // namespace touchstone::hil
