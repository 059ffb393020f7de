// The driver of QTM against packets written out from Qualisys' documentation, and an emulator of it. Emulated: they
// show that the driver keeps to the documentation, not that QTM does.
#include "drivers/qualisys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "emulators/qualisys_emulator.h"
#include "harness/base/random.h"

namespace touchstone::hil {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::span<const unsigned char> packet_bytes(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

// The time of a sample is in its z.
EmulatedPose screwing(double t) {
  return {Vec3(0.3 * std::cos(t), -0.2, 0.1 * t), Quat(Eigen::AngleAxisd(0.5 + t, Vec3(1, 2, -2) / 3.0)), true};
}
double time_at(const PoseSample& s) { return 10.0 * s.p_W_m.z(); }

std::unique_ptr<PoseSource> stylus_of(const QualisysEmulator& server) {
  return open_qualisys({"127.0.0.1", server.port(), "Stylus", 3.0, 0.0});
}

// So many samples, with the patience that a busy machine needs.
std::vector<PoseSample> poses_of(PoseSource& source, std::size_t count) {
  const double until = MonotonicClock().now_s() + 30.0;
  std::vector<PoseSample> all, some(64);
  while (all.size() < count) {
    const auto n = source.read(some, until);
    if (n == 0) break;
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

std::string complaint_of(const QualisysOptions& options) {
  try {
    const auto source = open_qualisys(options);
    source->start();
    poses_of(*source, 50);
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "opened";
}
std::string complaint_of(const QualisysFaults& faults, const std::string& body = "Stylus") {
  const QualisysEmulator server(500.0, faults, screwing);
  return complaint_of({"127.0.0.1", server.port(), body, 1.0, 0.0});
}

// The example of the documentation's section on commands ("Version 1.2"), with the zero that may follow.
TEST(Qualisys, ACommandIsAsTheDocumentationWritesIt) {
  EXPECT_EQ(qtm::command("Version 1.2"), std::string("\x14\0\0\0\x01\0\0\0Version 1.2\0", 20));
}

// A quarter turn about z takes x to y: the first column is (0, 1, 0). Behind a component of another kind.
TEST(Qualisys, AMatrixComesColumnByColumnAndLengthsInMillimetres) {
  const std::string packet(
      "\x68\0\0\0\x03\0\0\0"
      "\x40\x42\x0f\0\0\0\0\0"
      "\x2a\0\0\0"
      "\x02\0\0\0"
      "\x0c\0\0\0\x01\0\0\0"
      "\0\0\0\0"
      "\x44\0\0\0\x0b\0\0\0"
      "\x01\0\0\0"
      "\0\0\0\0"
      "\0\0\x7a\x44"
      "\0\0\x7a\xc4"
      "\0\0\0\x3f"
      "\0\0\0\0"
      "\0\0\x80\x3f"
      "\0\0\0\0"
      "\0\0\x80\xbf"
      "\0\0\0\0"
      "\0\0\0\0"
      "\0\0\0\0"
      "\0\0\0\0"
      "\0\0\x80\x3f"
      "\0\0\x80\x3e",
      0x68);
  const auto read = qtm::parse(packet_bytes(packet), "test");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->type, qtm::Type::data);
  EXPECT_EQ(read->bytes, packet.size());
  qtm::Frame frame;
  ASSERT_TRUE(qtm::parse_frame(read->content, frame));
  EXPECT_EQ(frame.time_us, 1000000);
  EXPECT_EQ(frame.number, 42U);
  ASSERT_EQ(frame.bodies.size(), 1U);
  EXPECT_TRUE(frame.bodies[0].tracked);
  EXPECT_LT((frame.bodies[0].p_W_m - Vec3(1.0, -1.0, 0.0005)).norm(), 1e-12);
  EXPECT_LT((frame.bodies[0].q_WB * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(frame.bodies[0].residual_m, 0.25e-3, 1e-12);
  for (std::size_t n = 0; n < packet.size(); ++n) {
    EXPECT_FALSE(qtm::parse(packet_bytes(packet).first(n), "test")) << n;
  }
  for (const unsigned char last_cell : {0xbf, 0x00, 0x7f}) {  // -1: a reflection; nearly 0; nearly 2^128
    std::string no_turn = packet;
    no_turn[packet.size() - 5] = static_cast<char>(last_cell);
    qtm::Frame odd;
    ASSERT_TRUE(qtm::parse_frame(qtm::parse(packet_bytes(no_turn), "test")->content, odd));
    EXPECT_FALSE(odd.bodies[0].tracked) << int{last_cell};
  }
  for (std::size_t n = 0; n < read->content.size(); ++n)
    EXPECT_FALSE(qtm::parse_frame(read->content.first(n), frame)) << n;
}

// Not a number, a matrix that stretches, and a place beyond every room.
TEST(Qualisys, WhatIsNoPoseIsNotTracked) {
  const auto first = [](const EmulatedPose& pose) {
    const QualisysEmulator server(500.0, {}, [&](double) { return pose; });
    const auto source = stylus_of(server);
    source->start();
    return poses_of(*source, 1).at(0);
  };
  EXPECT_EQ(first(screwing(0.0)).flags, recording::sample_ok);
  EmulatedPose lost = screwing(0.0);
  lost.tracked = false;
  for (const EmulatedPose& none : {lost, EmulatedPose{Vec3::Zero(), Quat(2, 0, 1, 0), true},
                                   EmulatedPose{Vec3(1e30, 0, 0), Quat::Identity(), true}}) {
    const PoseSample sample = first(none);
    EXPECT_EQ(sample.flags, recording::sample_not_tracked);
    EXPECT_EQ(sample.p_W_m, Vec3(Vec3::Zero()));
    EXPECT_EQ(sample.q_WB.coeffs(), Quat::Identity().coeffs());
  }
  EXPECT_EQ(first(lost).device_status, 0xffffffffU);
}

TEST(Qualisys, PosesComeWithTheCamerasTime) {
  const QualisysEmulator server(240.0, {}, screwing);
  const auto source = stylus_of(server);
  EXPECT_EQ(source->identity().serial, "Stylus");
  EXPECT_EQ(source->identity().firmware, "QTM Version is 2.17 (build 4000), protocol 1.8");
  EXPECT_TRUE(source->identity().emulated);
  EXPECT_EQ(source->ticks_per_s(), 1e6);
  for (int run = 0; run < 2; ++run) {
    source->start();
    const auto samples = poses_of(*source, 200);
    source->stop();
    ASSERT_GE(samples.size(), 200U);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double t = time_at(samples[i]);
      EXPECT_LT((samples[i].p_W_m - screwing(t).p_W_m).norm(), 1e-6);
      EXPECT_LT(samples[i].q_WB.angularDistance(screwing(t).q_WB), 1e-5);
      EXPECT_EQ(samples[i].flags, recording::sample_ok);
      EXPECT_EQ(samples[i].device_status, 432U) << "the residual";
      EXPECT_NEAR(1e-6 * static_cast<double>(samples[i].ticks - samples[0].ticks), t - time_at(samples[0]), 2e-6);
      EXPECT_EQ(samples[i].sequence, i);
    }
    EXPECT_EQ(source->counters().lost, 0U);
    EXPECT_EQ(source->counters().clock_steps, 0U);
  }
}

TEST(Qualisys, CountsWhatQtmLeavesOut) {
  QualisysFaults faults;
  faults.drop_every = 10;
  faults.repeat_every = 7;
  faults.damage_every = 13;
  for (const std::uint32_t step : {1U, 4U}) {
    faults.number_step = step;
    const QualisysEmulator server(1000.0, faults, screwing);
    const auto source = stylus_of(server);
    source->start();
    const auto samples = poses_of(*source, 500);
    ASSERT_GE(samples.size(), 500U);
    const auto c = source->counters();
    const double frames = 1000.0 * (time_at(samples.back()) - time_at(samples.front())) + 1.0;
    EXPECT_NEAR(static_cast<double>(c.received + c.lost), frames, 0.1);
    EXPECT_NEAR(static_cast<double>(c.lost), frames * (1.0 / 10 + 1.0 / 13 - 1.0 / 130), 3.0);
    EXPECT_GT(c.repeated, 30U);
    EXPECT_GT(c.malformed, 20U);
  }
}

TEST(Qualisys, SaysWhatIsWrong) {
  QualisysFaults faults;
  EXPECT_EQ(complaint_of(faults), "opened");
  EXPECT_THAT(complaint_of(faults, "Wand"), HasSubstr("no rigid body \"Wand\"; it has \"Table\", \"Stylus\""));
  EXPECT_THAT(complaint_of(faults, ""), HasSubstr("is not said; it has \"Table\", \"Stylus\""));
  faults.no_bodies = true;
  EXPECT_THAT(complaint_of(faults), HasSubstr("make a rigid body"));
  faults = {}, faults.full = true;
  EXPECT_THAT(complaint_of(faults), HasSubstr("Max number of clients"));
  faults = {}, faults.mute = true;
  EXPECT_THAT(complaint_of(faults), HasSubstr("its greeting did not come within 1 s"));
  faults = {}, faults.endless = true;
  EXPECT_THAT(complaint_of(faults), HasSubstr("its greeting did not come within 1 s"));
  faults = {}, faults.big_endian = true;
  EXPECT_THAT(complaint_of(faults), AllOf(HasSubstr("this is no QTM"), HasSubstr("22223")));
  faults = {}, faults.begins_again = 20;
  EXPECT_THAT(complaint_of(faults), HasSubstr("frame numbers began again, 1 after 1020"));
  faults = {}, faults.finishes_after = 20;
  EXPECT_THAT(complaint_of(faults), HasSubstr("no measurement runs"));
  faults = {}, faults.body_lost_after = 20;
  EXPECT_THAT(complaint_of(faults), HasSubstr("a frame has 1 bodies, and QTM named 2"));
}

TEST(Qualisys, AServerThatGoesIsGone) {
  QualisysEmulator server(240.0, {}, screwing);
  const auto source = stylus_of(server);
  source->start();
  poses_of(*source, 10);
  server.close();
  EXPECT_THROW(poses_of(*source, 100000), DeviceError);
  EXPECT_THAT(complaint_of({"127.0.0.1", server.port(), "Stylus", 1.0, 0.0}), HasSubstr("refused"));
}

TEST(Qualisys, NamesAreThoseOfTheBodiesAlone) {
  const auto names = qtm::parse_names(
      "<QTM_Parameters_Ver_1.25><The_6D><Body><Name>a &amp; b</Name><Mesh><Name>c.obj</Name></Mesh></Body>"
      "<Body><Name/></Body></The_6D></QTM_Parameters_Ver_1.25>");
  ASSERT_TRUE(names);
  EXPECT_THAT(*names, ElementsAre("a & b", ""));
  EXPECT_FALSE(qtm::parse_names("<QTM_Parameters_Ver_1.8><The_3D/></QTM_Parameters_Ver_1.8>"));
  EXPECT_FALSE(qtm::parse_names("no XML"));
}

}  // namespace
}  // namespace touchstone::hil
