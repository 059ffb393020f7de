// The NDI driver against an emulator that answers as ndicapi's parser expects. Emulated: it shows that the driver keeps
// to the commands that ndicapi sends and reads, not that a Polaris does.
#include "drivers/ndi.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "emulators/loopback_socket.h"
#include "emulators/ndi_emulator.h"
#include "harness/base/atomic_file.h"
#include "harness/base/random.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

EmulatedPose nod(double t) {
  return {Vec3(0.05 * std::cos(t), -0.1, -1.5 + 0.01 * t), Quat(Eigen::AngleAxisd(0.2 * t, Vec3::UnitZ())), true};
}

// Greetings and answers that ndicapi names: "RESETBE6F" and "OKAYA896".
TEST(Ndi, ChecksAsTheDeviceDoes) {
  EXPECT_EQ(ndi::crc16("RESET"), 0xbe6f);
  EXPECT_EQ(ndi::crc16("OKAY"), 0xa896);
  EXPECT_EQ(ndi::command("INIT:"), "INIT:E3A5\r");
  EXPECT_EQ(ndi::checked("OKAYA896\r"), "OKAY");
  EXPECT_FALSE(ndi::checked("OKAYA897\r"));
  EXPECT_FALSE(ndi::checked(""));
}

TEST(Ndi, ReadsAnAnswerToTX) {
  const auto tools = ndi::parse_tx(
      "0201+09659+00000+02588+00000-012345+000100-150000+00750000000310000ABCD\n"
      "02MISSING000000310000ABCD\n0000");
  ASSERT_TRUE(tools);
  ASSERT_EQ(tools->size(), 2U);
  const auto& tool = (*tools)[0];
  EXPECT_EQ(tool.handle, 1);
  EXPECT_NEAR(tool.q_WB.w(), 0.9659, 1e-12);
  EXPECT_NEAR(tool.q_WB.y(), 0.2588, 1e-12);
  EXPECT_LT((tool.p_W_m - Vec3(-0.12345, 0.001, -1.5)).norm(), 1e-12);
  EXPECT_EQ(tool.frame, 0xabcdU);
  EXPECT_TRUE((*tools)[1].missing);
}

std::vector<PoseSample> watch(PoseSource& source, double seconds) {
  MonotonicClock clock;
  std::vector<PoseSample> all, some(16);
  const double until = clock.now_s() + seconds;
  while (clock.now_s() < until) {
    const auto n = source.read(some, until);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

TEST(Ndi, PosesComeFrameByFrame) {
  NdiFaults faults;
  faults.missing_every = 10;
  NdiEmulator polaris(60.0, faults, nod);
  const auto source = open_ndi({"127.0.0.1", polaris.port(), 115200, "", 60.0, 3.0});
  EXPECT_TRUE(source->identity().emulated);
  source->start();
  const auto samples = watch(*source, 1.5);
  ASSERT_GT(samples.size(), 30U);
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) {
      EXPECT_GT(samples[i].sequence, samples[i - 1].sequence);
    }
    if ((samples[i].flags & recording::sample_not_tracked) != 0) {
      ++hidden;
      continue;
    }
    const double t = (samples[i].p_W_m.z() + 1.5) / 0.01;
    EXPECT_LT((samples[i].p_W_m - nod(t).p_W_m).norm(), 1e-4);
    EXPECT_LT(samples[i].q_WB.normalized().angularDistance(nod(t).q_WB), 1e-2);
  }
  EXPECT_GT(hidden, 0U);
}

// Frames are counted at 60 Hz whatever the tracking rate: what is skipped by design is not lost.
TEST(Ndi, SlowTrackingLosesNothing) {
  for (const double rate_Hz : {20.0, 30.0}) {
    NdiEmulator polaris(rate_Hz, {}, nod);
    const auto source = open_ndi({"127.0.0.1", polaris.port(), 115200, "", rate_Hz, 3.0});
    source->start();
    const auto samples = watch(*source, 1.5);
    ASSERT_GT(samples.size(), 15U) << rate_Hz;
    const std::uint64_t sent = samples.back().sequence - samples.front().sequence + 1;
    EXPECT_EQ(sent, samples.size() + source->counters().lost) << rate_Hz;
    EXPECT_NEAR((samples.back().p_W_m.z() - samples.front().p_W_m.z()) / 0.01, static_cast<double>(sent - 1) / rate_Hz,
                0.02)
        << rate_Hz;
  }
}

// What is no tracker may send for ever and never end an answer: neither memory nor the deadline depends on it.
TEST(Ndi, AnAnswerWithoutAnEndIsRefused) {
  NdiFaults faults;
  faults.endless = true;
  NdiEmulator polaris(60.0, faults, nod);
  const auto source = open_ndi({"127.0.0.1", polaris.port(), 115200, "", 60.0, 1.0});
  source->start();
  try {
    watch(*source, 2.0);
    ADD_FAILURE() << "read it";
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("without the end of an answer"));
  }
}

TEST(Ndi, APassiveToolIsDefinedFirst) {
  const auto rom = std::filesystem::temp_directory_path() / fmt::format("touchstone-tool-{}.rom", ::getpid());
  write_file(rom, std::string(752, 'x'));
  NdiEmulator polaris(60.0, {}, nod);
  const auto source = open_ndi({"127.0.0.1", polaris.port(), 115200, rom.string(), 60.0, 3.0});
  EXPECT_EQ(polaris.definition_bytes(), 768U) << "752 bytes in pieces of 64";
  source->start();
  EXPECT_FALSE(watch(*source, 0.5).empty());
  std::filesystem::remove(rom);
}

TEST(Ndi, WhatGoesWrongIsSaid) {
  const auto complaint = [](NdiFaults faults) -> std::string {
    NdiEmulator polaris(60.0, faults, nod);
    try {
      const auto source = open_ndi({"127.0.0.1", polaris.port(), 115200, "", 60.0, 2.0});
      source->start();
      watch(*source, 2.0);
    } catch (const DeviceError& error) {
      return error.what();
    }
    return "nothing";
  };
  NdiFaults faults;
  faults.no_tool = true;
  EXPECT_THAT(complaint(faults), HasSubstr("no tool is plugged in"));
  int port = 0;
  { port = NdiEmulator(60.0, {}, nod).port(); }
  EXPECT_THROW(open_ndi({"127.0.0.1", port, 115200, "", 60.0, 0.5}), DeviceError);
}

// One flipped bit in an hour is no reason to end a run.
TEST(Ndi, ADamagedAnswerIsCountedAndTheNextOneRead) {
  NdiFaults faults;
  faults.wrong_crc_every = 5;
  NdiEmulator polaris(60.0, faults, nod);
  const auto source = open_ndi({"127.0.0.1", polaris.port(), 115200, "", 60.0, 3.0});
  source->start();
  EXPECT_GT(watch(*source, 1.0).size(), 20U);
  EXPECT_GT(source->counters().malformed, 5U);
}

// The deadline is the caller's; the answer that comes after it belongs to the next call.
TEST(Ndi, ReadKeepsItsDeadline) {
  NdiFaults faults;
  faults.late_s = 0.5;
  NdiEmulator polaris(60.0, faults, nod);
  const auto source = open_ndi({"127.0.0.1", polaris.port(), 115200, "", 60.0, 3.0});
  source->start();
  MonotonicClock clock;
  std::vector<PoseSample> some(16);
  std::size_t came = 0;
  double longest = 0.0;
  for (const double until = clock.now_s() + 1.5; clock.now_s() < until;) {
    const double began = clock.now_s();
    came += source->read(some, began + 0.05);
    longest = std::max(longest, clock.now_s() - began);
  }
  EXPECT_LT(longest, 0.4) << "well before the answer";
  EXPECT_GE(came, 1U);
}

// The device keeps the speed that it was told: who opens it again begins at its first one.
TEST(Ndi, ALineIsLeftAsItWasFound) {
  const SerialEmulator line(ndi_on_a_line({}, nod));
  for (int run = 0; run < 2; ++run) {
    const auto source = open_ndi({line.node(), 0, 115200, "", 60.0, 3.0});
    source->start();
    EXPECT_FALSE(watch(*source, 0.3).empty()) << run;
  }
  NdiFaults faults;
  faults.no_tool = true;
  const SerialEmulator without(ndi_on_a_line(faults, nod));
  for (int run = 0; run < 2; ++run) {
    try {
      open_ndi({without.node(), 0, 115200, "", 60.0, 3.0});
      ADD_FAILURE() << "opened";
    } catch (const DeviceError& error) {
      EXPECT_THAT(error.what(), HasSubstr("no tool is plugged in")) << run;
    }
  }
}

// A pseudo-terminal carries no break: the time stands for it, at which the device greets.
TEST(Ndi, ADeviceAtAnotherSpeedIsResetByABreak) {
  NdiFaults faults;
  faults.deaf_s = 0.9;
  const SerialEmulator line(ndi_on_a_line(faults, nod));
  const auto source = open_ndi({line.node(), 0, 57600, "", 60.0, 3.0});
  source->start();
  EXPECT_FALSE(watch(*source, 0.3).empty());
}

// A listener whose queue is full answers no one: the kernel drops what would connect.
TEST(Ndi, ANetworkThatDoesNotAnswerIsSaidToBeSilent) {
  const LoopbackSocket full = listen_on_loopback();
  ::listen(full.fd, 0);
  std::vector<int> waiting;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(full.port));
  for (int i = 0; i < 4; ++i) {
    waiting.push_back(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    ::connect(waiting.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  try {
    open_ndi({"127.0.0.1", full.port, 115200, "", 60.0, 0.3});
    ADD_FAILURE() << "opened";
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no answer in time"));
  }
  for (const int fd : waiting) ::close(fd);
  ::close(full.fd);
}

TEST(Ndi, DamagedAnswersAreReadOrRefused) {
  const std::string whole = "0101+09659+00000+02588+00000-012345+000100-150000+00750000000310000ABCD\n0000";
  Random random(79);
  for (int trial = 0; trial < 20000; ++trial) {
    std::string damaged = whole.substr(0, random.below(whole.size() + 1));
    for (int k = 0; k < 2 && !damaged.empty(); ++k)
      damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
    ndi::parse_tx(damaged);
    ndi::checked(damaged);
  }
}

}  // namespace
}  // namespace touchstone::hil
