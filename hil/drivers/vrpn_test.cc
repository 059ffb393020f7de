// The VRPN driver against what a server built from VRPN's sources sent, and an emulator made of it.
#include "drivers/vrpn.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "drivers/byte_reader.h"
#include "emulators/vrpn_answers.h"
#include "emulators/vrpn_emulator.h"
#include "harness/base/random.h"

namespace touchstone::hil {
using recording::sample_not_tracked;

namespace {

using ::testing::HasSubstr;

EmulatedPose orbit(double t) {
  return {Vec3(0.2 * std::cos(t), 0.2 * std::sin(t), 0.01 * t), Quat(Eigen::AngleAxisd(0.3 * t, Vec3::UnitX())), true};
}

std::vector<PoseSample> poses_for(PoseSource& source, double seconds) {
  MonotonicClock clock;
  std::vector<PoseSample> all, some(64);
  const double until = clock.now_s() + seconds;
  while (clock.now_s() < until) {
    const auto n = source.read(some, until);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

TEST(Vrpn, ReadsACapturedServer) {
  const std::span<const unsigned char> captured(vrpn_greeting);
  EXPECT_TRUE(vrpn::cookie_agrees(captured));
  EXPECT_EQ(std::memcmp(vrpn::cookie().data(), captured.data(), 19), 0);
  std::vector<std::string> senders, types;
  auto rest = captured.subspan(vrpn::cookie_bytes);
  while (const auto m = vrpn::parse(rest, "captured")) {
    ByteReader reader(m->payload);
    reader.skip(4);
    (m->type == -1 ? senders : types).push_back(reader.text());
    rest = rest.subspan(m->bytes);
  }
  EXPECT_TRUE(rest.empty());
  EXPECT_THAT(senders, ::testing::Contains("Tracker0"));
  EXPECT_THAT(types, ::testing::Contains("vrpn_Tracker Pos_Quat"));
  // The server that was captured reported (0.1 cos t, 0.1 sin t, t), turned by 0.2 t about y.
  const auto report = vrpn::parse(std::span<const unsigned char>(vrpn_report), "captured");
  ASSERT_TRUE(report);
  ByteReader reader(report->payload);
  EXPECT_EQ(reader.big<std::int32_t>(), 0);
  reader.skip(4);
  const double x = reader.big<double>(), y = reader.big<double>(), t = reader.big<double>();
  EXPECT_NEAR(x, 0.1 * std::cos(t), 1e-12);
  EXPECT_NEAR(y, 0.1 * std::sin(t), 1e-12);
  reader.skip(8);
  EXPECT_NEAR(reader.big<double>(), std::sin(0.1 * t), 1e-12);
}

TEST(Vrpn, PosesComeWithTheServersTime) {
  VrpnEmulator server(200.0, orbit);
  auto options = vrpn_options("127.0.0.1", "Tracker0:0");
  options.port = server.port();
  const auto source = open_vrpn(options);
  EXPECT_EQ(source->identity().serial, "Tracker0:0");
  EXPECT_TRUE(source->identity().emulated);
  source->start();
  const auto samples = poses_for(*source, 1.0);
  ASSERT_GT(samples.size(), 80U);
  const double t0 = 100.0 * samples[0].p_W_m.z();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = 100.0 * samples[i].p_W_m.z();
    EXPECT_LT((samples[i].p_W_m - orbit(t).p_W_m).norm(), 1e-9);
    EXPECT_LT(samples[i].q_WB.angularDistance(orbit(t).q_WB), 1e-6);
    EXPECT_NEAR(1e-6 * static_cast<double>(samples[i].ticks - samples[0].ticks), t - t0, 0.3e-3);
  }
  EXPECT_EQ(source->counters().malformed, 0U);
}

TEST(Vrpn, AStepOfTheServersClockIsCountedAndBridgedByTheArrivals) {
  for (const double step_s : {0.4, -0.4}) {
    VrpnEmulator server(200.0, orbit);
    auto options = vrpn_options("127.0.0.1", "Tracker0:0");
    options.port = server.port();
    const auto source = open_vrpn(options);
    source->start();
    auto samples = poses_for(*source, 0.8);
    ASSERT_FALSE(samples.empty());
    server.set_clock(step_s);
    const auto later = poses_for(*source, 0.4);
    ASSERT_GT(later.size(), 10U);
    samples.insert(samples.end(), later.begin(), later.end());
    EXPECT_EQ(source->counters().clock_steps, 1U) << step_s;
    EXPECT_EQ(source->counters().repeated, 0U) << step_s;
    const double first_s = 100.0 * samples[0].p_W_m.z(), last_s = 100.0 * samples.back().p_W_m.z();
    // As the arrivals have it, which a busy machine makes late.
    EXPECT_NEAR(1e-6 * static_cast<double>(samples.back().ticks - samples[0].ticks), last_s - first_s, 0.1) << step_s;
  }
}

// Norms of 0 and 2 and a place beyond every room, as servers send them for a sensor that is not there.
TEST(Vrpn, WhatIsNoPoseIsNotTracked) {
  const auto flags_of = [](const EmulatedPose& pose) {
    VrpnEmulator server(200.0, [&](double) { return pose; });
    auto options = vrpn_options("127.0.0.1", "Tracker0:0");
    options.port = server.port();
    const auto source = open_vrpn(options);
    source->start();
    const auto samples = poses_for(*source, 0.1);
    return samples.empty() ? 0xffffffffU : samples[0].flags & sample_not_tracked;
  };
  EXPECT_EQ(flags_of({Vec3(1, 2, 3), Quat(0.6, 0.8, 0, 0), true}), 0U);
  EXPECT_EQ(flags_of({Vec3(1, 2, 3), Quat(0, 0, 0, 0), true}), sample_not_tracked);
  EXPECT_EQ(flags_of({Vec3(1, 2, 3), Quat(1.2, 1.6, 0, 0), true}), sample_not_tracked);
  EXPECT_EQ(flags_of({Vec3(1e308, 2, 3), Quat(1, 0, 0, 0), true}), sample_not_tracked);
}

TEST(Vrpn, TheOnlyTrackerNeedsNoNameAndAnotherSensorIsAnotherBody) {
  VrpnEmulator server(100.0, orbit);
  auto options = vrpn_options("127.0.0.1", "");
  options.port = server.port();
  options.sensor = 1;
  const auto source = open_vrpn(options);
  EXPECT_EQ(source->identity().serial, "Tracker0:1");
  source->start();
  const auto samples = poses_for(*source, 0.5);
  ASSERT_FALSE(samples.empty());
  EXPECT_GT(samples[0].p_W_m.z(), 0.9);
}

TEST(Vrpn, ASensorIsAWholeNumber) {
  EXPECT_EQ(vrpn_options("host", "Tracker0:12").sensor, 12);
  EXPECT_EQ(vrpn_options("host", "Tracker0:12").tracker, "Tracker0");
  for (const char* const body : {"Tracker0:left", "Tracker0:", "Tracker0:1x", "Tracker0:-1", "Tracker0:9999999999"})
    EXPECT_THROW(vrpn_options("host", body), UsageError) << body;
}

TEST(Vrpn, SaysWhatIsThereAndWhenTheServerGoes) {
  VrpnEmulator server(100.0, orbit);
  auto options = vrpn_options("127.0.0.1", "Wand");
  options.port = server.port();
  options.timeout_s = 1.0;
  try {
    open_vrpn(options);
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no tracker \"Wand\"; it has Tracker0"));
  }
  options.tracker = "Tracker0";
  const auto source = open_vrpn(options);
  source->start();
  poses_for(*source, 0.1);
  server.close();
  EXPECT_THROW(poses_for(*source, 2.0), DeviceError);
  EXPECT_THROW(open_vrpn(options), DeviceError);
}

TEST(Vrpn, DamagedStreamsAreReadOrRefused) {
  Random random(78);
  std::string whole(reinterpret_cast<const char*>(vrpn_greeting) + vrpn::cookie_bytes,
                    sizeof vrpn_greeting - vrpn::cookie_bytes);
  whole.append(reinterpret_cast<const char*>(vrpn_report), sizeof vrpn_report);
  for (int trial = 0; trial < 20000; ++trial) {
    std::string damaged = whole;
    for (int k = 0; k < 4; ++k) damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
    std::span<const unsigned char> rest(reinterpret_cast<const unsigned char*>(damaged.data()), damaged.size());
    try {
      while (const auto m = vrpn::parse(rest, "damaged")) rest = rest.subspan(m->bytes);
    } catch (const DeviceError& error) {
      EXPECT_THAT(error.what(), HasSubstr("no VRPN stream"));
    }
  }
}

}  // namespace
}  // namespace touchstone::hil
