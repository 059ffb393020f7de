// Drivers on serial lines against emulators at the other end of a pseudo-terminal. Emulated: they show that the drivers
// keep to the published protocols, not that a sensor does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "harness/base/error.h"
#include "hil/drivers/bota.h"
#include "hil/drivers/load_cell.h"
#include "hil/emulators/serial_emulator.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

Wrench swaying(double t) { return {Vec3(std::sin(t), 5.0, -t), Vec3(0.1, 0.01 * t, -0.2)}; }

std::vector<WrenchSample> collect(WrenchSource& source, double seconds) {
  MonotonicClock clock;
  std::vector<WrenchSample> all, some(64);
  const double until = clock.now_s() + seconds;
  while (clock.now_s() < until) {
    const auto n = source.read(some, until);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

// The check value that catalogues of checksums give for CRC-16/X-25.
TEST(Bota, ChecksAsX25Does) {
  const std::string text = "123456789";
  EXPECT_EQ(bota::crc_x25({reinterpret_cast<const unsigned char*>(text.data()), text.size()}), 0x906e);
}

TEST(Bota, ReadsNewtonsAtTheRateThatWasAskedFor) {
  SerialEmulator sensor(bota_sensor({}, swaying));
  const auto source = open_bota({sensor.node(), 460800, 128, 3.0});
  EXPECT_EQ(source->nominal_rate_Hz(), 400.0);
  EXPECT_TRUE(source->identity().emulated);
  source->start();
  const auto samples = collect(*source, 1.0);
  ASSERT_GT(samples.size(), 200U);
  EXPECT_EQ(source->counters().lost, 0U);
  EXPECT_LE(source->counters().malformed, 1U) << "the first frame may be cut";
  // Which frame was the first is not known; the z force says its time.
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double t = -samples[i].wrench.f_N.z();
    EXPECT_LT((samples[i].wrench.f_N - swaying(t).f_N).norm(), 1e-5);
    EXPECT_LT((samples[i].wrench.torque_Nm - swaying(t).torque_Nm).norm(), 1e-6);
    EXPECT_NEAR(t + samples[0].wrench.f_N.z(), 2.5e-3 * static_cast<double>(samples[i].sequence), 1e-5);
  }
}

TEST(Bota, CountsLostDamagedAndFlaggedFrames) {
  BotaFaults faults;
  faults.drop_every = 20;
  faults.damage_every = 33;
  faults.status_every = 50;
  SerialEmulator sensor(bota_sensor(faults, swaying));
  const auto source = open_bota({sensor.node(), 460800, 128, 3.0});
  source->start();
  const auto samples = collect(*source, 1.5);
  ASSERT_GT(samples.size(), 200U);
  const auto c = source->counters();
  std::uint64_t gaps = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) gaps += samples[i].sequence - samples[i - 1].sequence - 1;
  EXPECT_EQ(c.lost, gaps);
  EXPECT_NEAR(static_cast<double>(c.lost), static_cast<double>(samples.size()) * (1.0 / 20 + 1.0 / 33), 8.0);
  EXPECT_GT(c.malformed, 3U);
  EXPECT_GT(c.device_errors, 3U);
}

TEST(Bota, SaysWhatToDoWhenItIsSilentRefusesOrIsNotThere) {
  const auto complaint = [](const BotaOptions& options) -> std::string {
    try {
      open_bota(options);
    } catch (const DeviceError& error) {
      return error.what();
    }
    return "opened";
  };
  SerialEmulator silent([](const std::string&, double) { return std::string(); });
  EXPECT_THAT(complaint({silent.node(), 460800, 128, 0.3}), HasSubstr("off and on"));
  BotaFaults faults;
  faults.refuses_filter = true;
  SerialEmulator refuses(bota_sensor(faults, swaying));
  EXPECT_THAT(complaint({refuses.node(), 460800, 128, 2.0}), HasSubstr("it refuses \"f,128"));
  EXPECT_THAT(complaint({"/dev/no-such-line", 460800, 128, 0.3}), HasSubstr("/dev/no-such-line"));
  EXPECT_THAT(complaint({silent.node(), 12345, 128, 0.3}), HasSubstr("12345 baud"));
}

TEST(Bota, AnUnpluggedLineIsGone) {
  SerialEmulator sensor(bota_sensor({}, swaying));
  const auto source = open_bota({sensor.node(), 460800, 128, 3.0});
  source->start();
  collect(*source, 0.2);
  sensor.unplug();
  EXPECT_THROW(collect(*source, 2.0), DeviceError);
}

TEST(LoadCell, FindsTheNumberInALine) {
  EXPECT_EQ(number_in_line("one reading:\t-12.3\t| average:\t12.4", 1), -12.3);
  EXPECT_EQ(number_in_line("one reading:\t-12.3\t| average:\t12.4", 2), 12.4);
  EXPECT_EQ(number_in_line("Load_cell output val: 1e2", 1), 100.0);
  EXPECT_EQ(number_in_line("8388607\r", 1), 8388607.0);
  EXPECT_EQ(number_in_line("1234,5.5,g,21.2", 2), 5.5);
  EXPECT_FALSE(number_in_line("HX711 Demo", 1));
  EXPECT_FALSE(number_in_line("Tare complete", 1));
  EXPECT_FALSE(number_in_line("12.3", 2));
  EXPECT_FALSE(number_in_line("", 1));
  EXPECT_FALSE(number_in_line("-", 1));
}

TEST(LoadCell, ReadsWhatTheLibrariesSketchesPrint) {
  for (const bool adc : {false, true}) {
    SerialEmulator sketch(load_cell_sketch(adc, 80.0, [](double t) { return 100.0 + 10.0 * t; }));
    const auto source = open_load_cell({sketch.node(), adc ? 57600 : 38400, 0.00980665, 1, 'x', 80.0});
    EXPECT_FALSE(source->numbers_records());
    source->start();
    const auto samples = collect(*source, 1.0);
    ASSERT_GT(samples.size(), 40U);
    for (std::size_t i = 1; i < samples.size(); ++i) {
      EXPECT_GE(samples[i].wrench.f_N.x(), samples[i - 1].wrench.f_N.x());
      EXPECT_GT(samples[i].wrench.f_N.x(), 99.0 * 0.00980665);
      EXPECT_LT(samples[i].wrench.f_N.x(), 200.0 * 0.00980665);
      EXPECT_EQ(samples[i].wrench.f_N.z(), 0.0);
    }
  }
}

TEST(LoadCell, WithoutAScaleItIsRefused) {
  EXPECT_THROW(open_load_cell({"/dev/null", 57600, 0.0, 1, 'z', 0.0}), UsageError);
}

}  // namespace
}  // namespace touchstone::hil
