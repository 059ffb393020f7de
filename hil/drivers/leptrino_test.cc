// Leptrino's driver against messages written out from the maker's specification, and an emulator of it at the other end
// of a pseudo-terminal. Emulated: they show that the driver keeps to the specification, not that a sensor does.
#include "drivers/leptrino.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "emulators/serial_emulator.h"
#include "harness/base/random.h"

namespace touchstone::hil {
namespace {

using leptrino::Command;
using leptrino::Piece;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::span<const unsigned char> line_bytes(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

// The time of a sample is in its z force.
Wrench leaning(double t) { return {Vec3(std::sin(t), 5.0, -t), Vec3(0.1, 0.01 * t, -0.2)}; }
// The rated force of a sensor whose counts along z are 4 ms.
constexpr float fine_N = 20.0F;
double time_in(const WrenchSample& s) { return -s.wrench.f_N.z(); }

// So many samples, with the patience that a busy machine needs.
std::vector<WrenchSample> samples_of(WrenchSource& source, std::size_t count) {
  const double until = MonotonicClock().now_s() + 30.0;
  std::vector<WrenchSample> all, some(64);
  while (all.size() < count) {
    const auto n = source.read(some, until);
    if (n == 0) break;
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

std::unique_ptr<WrenchSource> open_at(const SerialEmulator& sensor, double rate_Hz = 0.0) {
  return open_leptrino({sensor.node(), 460800, rate_Hz, 3.0});
}

// Section 3.1 and 5.1: length 4, 0xff, the command, 0; their exclusive or with ETX is 0xd2.
TEST(Leptrino, ACommandIsAsTheSpecificationWritesIt) {
  EXPECT_EQ(leptrino::message(Command::product), std::string("\x10\x02\x04\xff\x2a\x00\x10\x03\xd2", 9));
}

// Rated 300 N; Fx is 4112 counts, 0x1010, of which each byte is doubled and counts once.
TEST(Leptrino, ADoubledByteIsOne) {
  const std::string text(
      "\x10\x02\x14\xff\x32\x00\x10\x10\x10\x10\xff\xff\x00\x80\x01\x00\x02\x00\x03\x00\x00\x00\x05\x00\x10\x03\x5f",
      27);
  const auto next = leptrino::next_piece(line_bytes(text));
  ASSERT_EQ(next.piece, Piece::content);
  EXPECT_EQ(next.used, text.size());
  const auto sample = leptrino::parse_sample(next.content);
  ASSERT_TRUE(sample);
  EXPECT_THAT(sample->counts, ::testing::ElementsAre(4112, -1, -32768, 1, 2, 3));
  EXPECT_EQ(sample->status, 5);
}

TEST(Leptrino, EveryCutIsIncompleteAndEveryWrongByteIsDamage) {
  const std::string text = leptrino::message(Command::start);
  for (std::size_t n = 0; n < text.size(); ++n)
    EXPECT_EQ(leptrino::next_piece(line_bytes(text.substr(0, n))).piece, Piece::incomplete) << n;
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string wrong = text + text;
      wrong[i] = static_cast<char>(wrong[i] ^ (1 << bit));
      // What it makes of it is no message, and it comes to the next one.
      std::span<const unsigned char> rest = line_bytes(wrong);
      auto next = leptrino::next_piece(rest);
      EXPECT_NE(next.piece, Piece::content) << i << ' ' << bit;
      while (next.piece != Piece::incomplete && next.piece != Piece::content) {
        ASSERT_GT(next.used, 0U);
        rest = rest.subspan(next.used);
        next = leptrino::next_piece(rest);
      }
      if (next.piece == Piece::content) {
        EXPECT_EQ(next.content, std::string("\x04\xff\x32\x00", 4));
      }
    }
  }
}

TEST(Leptrino, ReadsUnitsRateAndNamesFromTheSensor) {
  for (const float rated_N : {20.0F, 200.0F, 2000.0F}) {
    LeptrinoFaults faults;
    faults.rated_force_N = rated_N;
    faults.was_sending = true;
    SerialEmulator sensor(leptrino_sensor(faults, leaning));
    const auto source = open_at(sensor);
    EXPECT_EQ(source->identity().id, "leptrino-serial");
    EXPECT_EQ(source->identity().serial, "2606008");
    EXPECT_EQ(source->identity().firmware, "PFS055YA251U6, firmware 4009");
    EXPECT_THAT(source->identity().calibration, HasSubstr(fmt::format("rated {0} {0} {1} N", rated_N, 2 * rated_N)));
    EXPECT_TRUE(source->identity().emulated);
    EXPECT_EQ(source->nominal_rate_Hz(), 1200.0);
    source->start();
    const auto samples = samples_of(*source, 600);
    ASSERT_GE(samples.size(), 600U);
    // Half a count of each axis.
    for (const WrenchSample& s : samples) {
      const double t = time_in(s);
      EXPECT_NEAR(s.wrench.f_N.x(), std::sin(t), 1.6e-4 * rated_N);
      EXPECT_NEAR(s.wrench.f_N.y(), 5.0, 0.51e-4 * rated_N);
      EXPECT_NEAR(s.wrench.torque_Nm.y(), 0.01 * t, 0.04e-4 * rated_N);
      EXPECT_NEAR(s.wrench.torque_Nm.z(), -0.2, 0.016e-4 * rated_N);
      EXPECT_EQ(s.flags, recording::sample_ok);
      EXPECT_EQ(s.device_status, 0U);
    }
  }
}

TEST(Leptrino, ProtocolOneThirteenDoesNotSayItsRate) {
  LeptrinoFaults faults;
  faults.rate.clear();
  SerialEmulator sensor(leptrino_sensor(faults, leaning));
  EXPECT_EQ(open_at(sensor, 1000.0)->nominal_rate_Hz(), 1000.0);
  EXPECT_THROW(open_at(sensor), DeviceError);
}

// As of a line whose reader was late: a message is cut, and nothing says how many are missing behind it.
TEST(Leptrino, WhatOverflowsIsCountedByTheRate) {
  LeptrinoFaults faults;
  faults.overflow_at = 500;
  faults.rated_force_N = fine_N;
  SerialEmulator sensor(leptrino_sensor(faults, leaning));
  const auto source = open_at(sensor);
  source->start();
  const auto samples = samples_of(*source, 1000);
  ASSERT_GE(samples.size(), 1000U);
  // By as much as a busy machine reads the first one behind it late.
  EXPECT_NEAR(static_cast<double>(source->counters().lost), 601.0, 60.0);
  const auto numbers = static_cast<double>(samples.back().sequence - samples.front().sequence);
  EXPECT_NEAR(numbers / 1200.0, time_in(samples.back()) - time_in(samples.front()), 0.05);
}

TEST(Leptrino, ADamagedMessageIsALostSample) {
  LeptrinoFaults faults;
  faults.damage_every = 40;
  faults.rated_force_N = fine_N;
  SerialEmulator sensor(leptrino_sensor(faults, leaning));
  const auto source = open_at(sensor);
  source->start();
  const auto samples = samples_of(*source, 1200);
  ASSERT_GE(samples.size(), 1200U);
  const auto c = source->counters();
  EXPECT_GT(c.malformed, 25U);
  EXPECT_EQ(c.lost, c.malformed);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const auto ahead = samples[i].sequence - samples[i - 1].sequence;
    EXPECT_NEAR(time_in(samples[i]) - time_in(samples[i - 1]), static_cast<double>(ahead) / 1200.0, 0.005);
    EXPECT_EQ((samples[i].flags & recording::sample_after_gap) != 0, ahead > 1);
  }
}

// The recorder holds the rate against the one that the sensor states, and the axis against its arrivals.
TEST(Leptrino, WholeMessagesThatAreLostShowInTheRateAlone) {
  LeptrinoFaults faults;
  faults.drop_every = 10;
  faults.rated_force_N = fine_N;
  SerialEmulator sensor(leptrino_sensor(faults, leaning));
  const auto source = open_at(sensor);
  source->start();
  const auto samples = samples_of(*source, 2000);
  ASSERT_GE(samples.size(), 2000U);
  EXPECT_EQ(source->counters().lost, 0U);
  const double seconds = time_in(samples.back()) - time_in(samples.front());
  EXPECT_NEAR(static_cast<double>(samples.size() - 1) / seconds, 0.9 * source->nominal_rate_Hz(), 10.0);
}

TEST(Leptrino, EachBitOfTheStatusIsSaid) {
  const auto flags_of = [](unsigned char status) {
    LeptrinoFaults faults;
    faults.status_every = 3;
    faults.status = status;
    SerialEmulator sensor(leptrino_sensor(faults, leaning));
    const auto source = open_at(sensor);
    source->start();
    std::uint32_t flags = 0;
    for (const WrenchSample& s : samples_of(*source, 30)) {
      EXPECT_EQ(s.device_status, s.flags == 0 ? 0U : status);
      flags |= s.flags;
    }
    EXPECT_GT(source->counters().device_errors, 5U);
    return flags;
  };
  EXPECT_EQ(flags_of(1), recording::sample_device_error);
  EXPECT_EQ(flags_of(2), recording::sample_device_error);
  EXPECT_EQ(flags_of(4), recording::sample_out_of_range);
}

TEST(Leptrino, AForceBeyondItsCountsIsSaturated) {
  SerialEmulator sensor(leptrino_sensor({}, [](double) { return Wrench{Vec3(-700.0, 0, 0), Vec3::Zero()}; }));
  const auto source = open_at(sensor);
  source->start();
  const auto samples = samples_of(*source, 1);
  ASSERT_FALSE(samples.empty());
  EXPECT_NEAR(samples[0].wrench.f_N.x(), -640.0, 1e-9);
  EXPECT_EQ(samples[0].flags, recording::sample_saturated);
}

TEST(Leptrino, ADamagedCommandIsSentAgain) {
  LeptrinoFaults faults;
  faults.damaged_commands = 2;
  SerialEmulator sensor(leptrino_sensor(faults, leaning));
  EXPECT_EQ(open_at(sensor)->identity().serial, "2606008");
}

TEST(Leptrino, SaysWhatToDoWhenItIsSilentRefusesOrIsNotThere) {
  const auto complaint = [](const SerialEmulator& sensor, double timeout_s) -> std::string {
    try {
      const auto source = open_leptrino({sensor.node(), 460800, 0.0, timeout_s});
      source->start();
      samples_of(*source, 10);
    } catch (const DeviceError& error) {
      return error.what();
    }
    return "opened";
  };
  SerialEmulator silent([](const std::string&, double, int) { return std::string(); });
  EXPECT_THAT(complaint(silent, 0.3), AllOf(HasSubstr("no answer to command 0x33"), HasSubstr("460800 baud")));
  SerialEmulator garbage([](const std::string&, double, int) { return std::string(40, 'x'); });
  EXPECT_THAT(complaint(garbage, 0.3), HasSubstr("no answer to command 0x33"));
  LeptrinoFaults faults;
  faults.damaged_commands = 1000;
  SerialEmulator deaf(leptrino_sensor(faults, leaning));
  EXPECT_THAT(complaint(deaf, 0.3), HasSubstr("came to it damaged"));
  faults = {};
  faults.start_result = 4;
  SerialEmulator refuses(leptrino_sensor(faults, leaning));
  EXPECT_THAT(complaint(refuses, 3.0), HasSubstr("it does not start: the sensor's state does not allow it"));
  faults = {};
  faults.rated_force_N = 0.0F;
  SerialEmulator unrated(leptrino_sensor(faults, leaning));
  EXPECT_THAT(complaint(unrated, 0.6), HasSubstr("none of its forms"));
  faults = {};
  faults.endless = true;
  SerialEmulator endless(leptrino_sensor(faults, leaning));
  EXPECT_EQ(complaint(endless, 3.0), "opened");
  EXPECT_THROW(open_leptrino({"/dev/no-such-line", 460800, 0.0, 0.3}), DeviceError);
}

TEST(Leptrino, AnUnpluggedLineIsGone) {
  SerialEmulator sensor(leptrino_sensor({}, leaning));
  const auto source = open_at(sensor);
  source->start();
  samples_of(*source, 100);
  sensor.unplug();
  EXPECT_THROW(samples_of(*source, 100000), DeviceError);
}

TEST(Leptrino, DamagedStreamsAreReadOrRefused) {
  Random random(80);
  const std::string whole = leptrino::message(Command::rated_values) + leptrino::message(Command::start);
  for (int trial = 0; trial < 20000; ++trial) {
    std::string damaged = whole;
    for (int k = 0; k < 3; ++k) damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
    std::span<const unsigned char> rest = line_bytes(damaged);
    for (auto next = leptrino::next_piece(rest); next.piece != Piece::incomplete; next = leptrino::next_piece(rest)) {
      ASSERT_GT(next.used, 0U);
      ASSERT_LE(next.used, rest.size());
      rest = rest.subspan(next.used);
    }
  }
}

}  // namespace
}  // namespace touchstone::hil
