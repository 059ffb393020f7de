// Drivers on serial lines against emulators at the other end of a pseudo-terminal. Emulated: they show that the drivers
// keep to the published protocols, not that a sensor does.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "drivers/bota.h"
#include "drivers/load_cell.h"
#include "emulators/serial_emulator.h"
#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Wrench swaying(double t) { return {Vec3(std::sin(t), 5.0, -t), Vec3(0.1, 0.01 * t, -0.2)}; }

std::vector<WrenchSample> collect(WrenchSource& source, double seconds, std::size_t enough = 100000) {
  MonotonicClock clock;
  std::vector<WrenchSample> all, some(64);
  const double until = clock.now_s() + seconds;
  while (clock.now_s() < until && all.size() < enough) {
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

// A frame whose checksum is right and whose force is none: a sensor says so, the line did not damage it.
TEST(Bota, AForceThatIsNoNumberIsNone) {
  std::vector<unsigned char> frame(bota::frame_bytes, 0);
  frame[0] = bota::header;
  const auto read = [&] {
    const std::span<const unsigned char> all(frame);
    const std::uint16_t sum = bota::crc_x25(all.subspan(1, bota::frame_bytes - 3));
    frame[bota::frame_bytes - 2] = static_cast<unsigned char>(sum & 0xff);
    frame[bota::frame_bytes - 1] = static_cast<unsigned char>(sum >> 8);
    return bota::decode(all.first<bota::frame_bytes>()).has_value();
  };
  EXPECT_TRUE(read());
  const float none = std::numeric_limits<float>::quiet_NaN();
  for (const std::size_t at : {std::size_t{3}, std::size_t{3 + 5 * 4}}) {  // of the forces and of the torques
    std::memcpy(frame.data() + at, &none, sizeof none);
    EXPECT_FALSE(read());
    std::memset(frame.data() + at, 0, sizeof none);
  }
}

// The speed's codes are those of Bota's example (bota.h): the sensor is told the speed that its line has.
TEST(Bota, StaysAtTheSpeedOfItsLine) {
  std::string told;
  BotaFaults faults;
  faults.configured = [&](const std::string& command) { told = command; };
  SerialEmulator sensor(bota_sensor(faults, swaying));
  open_bota({sensor.node(), 115200, 256, 3.0});
  sensor.unplug();
  EXPECT_EQ(told, "c,0,1,0,2");
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

// Two steps are the shortest for the first second: what was lost then shows when one step comes.
TEST(Bota, CountsWhatWasLostBeforeTheFirstUndisturbedStep) {
  BotaFaults faults;
  faults.halved_until = 400;
  SerialEmulator sensor(bota_sensor(faults, swaying));
  const auto source = open_bota({sensor.node(), 460800, 128, 3.0});
  source->start();
  const auto time_of = [](const WrenchSample& s) { return -s.wrench.f_N.z(); };
  std::vector<WrenchSample> samples;
  for (int i = 0; i < 100 && (samples.empty() || time_of(samples.back()) < 1.2); ++i) {
    const auto more = collect(*source, 0.1);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  ASSERT_FALSE(samples.empty());
  ASSERT_LT(time_of(samples.front()), 0.8) << "too little of the disturbed part came";
  ASSERT_GT(time_of(samples.back()), 1.1);
  const auto frames =
      static_cast<std::uint64_t>(std::lround((time_of(samples.back()) - time_of(samples.front())) / 2.5e-3)) + 1;
  const auto c = source->counters();
  EXPECT_GT(c.lost, 50U);
  EXPECT_EQ(c.received + c.lost, frames);
  EXPECT_EQ(samples.back().sequence - samples.front().sequence + 1, frames);
  EXPECT_EQ(std::count_if(samples.begin(), samples.end(),
                          [](const WrenchSample& s) { return s.flags != recording::sample_ok; }),
            1)
      << "the sample at which it shows is the one after the gap";
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

// Its time falls then, which is a step of nearly 2^32, and no 1.7 million lost frames.
TEST(Bota, ASensorThatWasResetHasLostNothingThatCouldBeCounted) {
  BotaFaults faults;
  faults.resets_at = 200;
  SerialEmulator sensor(bota_sensor(faults, swaying));
  const auto source = open_bota({sensor.node(), 460800, 128, 3.0});
  source->start();
  const auto samples = collect(*source, 20.0, 251);
  ASSERT_GT(samples.size(), 250U);
  EXPECT_EQ(source->counters().lost, 0U);
  EXPECT_EQ(std::count_if(samples.begin(), samples.end(),
                          [](const WrenchSample& s) { return (s.flags & recording::sample_after_gap) != 0; }),
            1);
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
  SerialEmulator silent([](const std::string&, double, int) { return std::string(); });
  EXPECT_THAT(complaint({silent.node(), 460800, 128, 0.3}), HasSubstr("off and on"));
  BotaFaults faults;
  faults.refuses_filter = true;
  SerialEmulator refuses(bota_sensor(faults, swaying));
  EXPECT_THAT(complaint({refuses.node(), 460800, 128, 2.0}), HasSubstr("it refuses \"f,128"));
  EXPECT_THAT(complaint({"/dev/no-such-line", 460800, 128, 0.3}), HasSubstr("/dev/no-such-line"));
  // What is wrong is the hardware map: a sensor that is switched off and on is no better.
  EXPECT_THAT(complaint({silent.node(), 12345, 128, 0.3}),
              AllOf(HasSubstr("12345 baud"), HasSubstr("115200"), Not(HasSubstr("off and on"))));
  EXPECT_THAT(complaint({silent.node(), 921600, 128, 0.3}), AllOf(HasSubstr("921600 baud"), HasSubstr("460800 are")));
  EXPECT_THAT(complaint({silent.node(), 9600, 128, 0.3}), HasSubstr("400 frames a second"));
  EXPECT_THAT(complaint({"/dev/null", 460800, 128, 0.3}), AllOf(HasSubstr("right node"), Not(HasSubstr("off and on"))));
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
  EXPECT_FALSE(number_in_line("+", 1));
  EXPECT_EQ(number_in_line("load: -.25", 1), -0.25);
  EXPECT_EQ(number_in_line(".5", 1), 0.5);
  EXPECT_EQ(number_in_line("done. 7", 1), 7.0);
  // What Arduino prints for a number that is none stands in a number's place.
  EXPECT_FALSE(number_in_line("one reading:\tnan\t| average:\t12.4", 1));
  EXPECT_EQ(number_in_line("one reading:\tnan\t| average:\t12.4", 2), 12.4);
  EXPECT_FALSE(number_in_line("val: ovf 3", 1));
  EXPECT_FALSE(number_in_line("val: -inf 3", 1));
  EXPECT_EQ(number_in_line("info 3", 1), 3.0);
}

std::unique_ptr<WrenchSource> open_cell(const SerialEmulator& sketch, int baud = 57600) {
  return open_load_cell({sketch.node(), baud, 1.0, 1, 'z', 0.0});
}

// A sketch that says the first text at once, and the second when it may.
SerialEmulator::Device says(std::string first, std::string second, const std::atomic<bool>& may) {
  return [first = std::move(first), second = std::move(second), &may](const std::string&, double, int) mutable {
    return may && first.empty() ? std::exchange(second, "") : std::exchange(first, "");
  };
}

// So many samples, with the patience that a busy machine needs.
std::vector<WrenchSample> collect_count(WrenchSource& source, std::size_t count) {
  const double until = MonotonicClock().now_s() + 30.0;
  std::vector<WrenchSample> all;
  std::array<WrenchSample, 4> some;
  while (all.size() < count) {
    const auto n = source.read(some, until);
    if (n == 0) break;
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

// An adapter hands on at once what came in 16 ms: each line was on the wire before the next.
TEST(LoadCell, LinesThatComeTogetherHaveTimesOfTheirOwn) {
  std::atomic<bool> started{false};
  const SerialEmulator sketch(says("a 1\na 2\na 3\n", "a 4\na 5\na 6\na 7\n", started));
  const auto source = open_cell(sketch);
  source->start();
  // No sooner than a line at this speed could: its second text takes 3 ms.
  MonotonicClock clock;
  clock.sleep_until(clock.now_s() + 0.01);
  started = true;
  const auto samples = collect_count(*source, 3);
  ASSERT_EQ(samples.size(), 3U) << "the first after start() may be the end of one";
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_NEAR(samples[i].t_s - samples[i - 1].t_s, 10.0 * 4 / 57600, 2e-6);
    EXPECT_EQ(samples[i].wrench.f_N.z(), samples[i - 1].wrench.f_N.z() + 1.0);
  }
}

TEST(LoadCell, WholeLinesAreKeptForALateReader) {
  std::string all;
  for (int i = 100; i < 400; ++i) all += fmt::format("{}\n", i);
  std::atomic<bool> started{false};
  const SerialEmulator sketch(says("1\n2\n3\n", all + std::string(2000, 'x') + "7\n8\n9\n", started));
  const auto source = open_cell(sketch);
  source->start();
  started = true;
  std::vector<double> read;
  for (const WrenchSample& sample : collect_count(*source, 301)) read.push_back(sample.wrench.f_N.z());
  std::vector<double> expected(299);  // less the first
  std::iota(expected.begin(), expected.end(), 101.0);
  expected.insert(expected.end(), {8.0, 9.0});
  EXPECT_EQ(read, expected);
  EXPECT_EQ(source->counters().malformed, 1U) << "what is too long for a line";
}

// A start-up between readings, as of a microcontroller that resets itself, is none.
TEST(LoadCell, OnlyLinesWithTheWordsOfReadingsAreReadings) {
  std::atomic<bool> started{false};
  const SerialEmulator sketch(says("load: 1.0 g\nload: 1.0 g\nload: 1.0 g\n",
                                   "load: 1.0 g\nload: 2.0 g\nraw: -153217\nmean: -153216\nload: 3.0 g\n", started));
  const auto source = open_cell(sketch);
  source->start();
  started = true;
  const auto samples = collect_count(*source, 2);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].wrench.f_N.z(), 2.0);
  EXPECT_EQ(samples[1].wrench.f_N.z(), 3.0);
  EXPECT_EQ(source->counters().malformed, 2U);
}

TEST(LoadCell, ReadsWhatTheLibrariesSketchesPrint) {
  for (const bool adc : {false, true}) {
    SerialEmulator sketch(load_cell_sketch(adc, 80.0, [](double t) { return 100.0 + 10.0 * t; }));
    const auto source = open_load_cell({sketch.node(), adc ? 57600 : 38400, 0.00980665, 1, 'x', 80.0});
    EXPECT_FALSE(source->numbers_records());
    source->start();
    const auto samples = collect(*source, 1.0);
    ASSERT_GT(samples.size(), 40U);
    EXPECT_GT(samples[0].wrench.f_N.x(), 99.0 * 0.00980665) << "what it prints before its readings is no force";
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
