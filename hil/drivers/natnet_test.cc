// The NatNet driver against packets captured from Motive 2.1 (natnet_answers.h), and against an emulator that is itself
// held against these packets.
#include "drivers/natnet.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "emulators/natnet_answers.h"
#include "emulators/natnet_emulator.h"
#include "harness/base/random.h"

namespace touchstone::hil {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

std::span<const unsigned char> bytes_of(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

template <std::size_t n>
std::span<const unsigned char> bytes_of(const unsigned char (&captured)[n]) {
  return {captured, n};
}
template <std::size_t n>
std::string text_of(const unsigned char (&captured)[n]) {
  return {reinterpret_cast<const char*>(captured), n};
}

const natnet::Version three{3, 0};

TEST(NatNetCaptured, TheServerSaysWhoItIs) {
  const auto info = natnet::parse_server_info(bytes_of(natnet_server_info));
  ASSERT_TRUE(info);
  EXPECT_EQ(info->application, "Motive");
  EXPECT_EQ(info->application_version.major, 2);
  EXPECT_EQ(info->application_version.minor, 1);
  EXPECT_EQ(info->natnet_version.major, 3);
  EXPECT_EQ(info->ticks_per_s, 3312787);
  EXPECT_EQ(info->data_port, 1511);
  EXPECT_TRUE(info->multicast);
  EXPECT_THAT(info->group, ElementsAre(239, 255, 42, 99));
}

TEST(NatNetCaptured, ABodyIsWhereTheSampleClientSawIt) {
  natnet::Frame frame;
  ASSERT_TRUE(natnet::parse_frame(bytes_of(natnet_frame), three, frame));
  EXPECT_EQ(frame.number, 162734U);
  ASSERT_EQ(frame.bodies.size(), 1U);
  const natnet::Body& body = frame.bodies[0];
  EXPECT_EQ(body.id, 2);
  EXPECT_TRUE(body.tracked);
  EXPECT_LT((body.p_W_m - Vec3(0.1744466, 1.4471314, -0.7343040)).norm(), 1e-6);
  EXPECT_LT((body.q_WB.coeffs() - Eigen::Vector4d(-0.05459423, 0.5099482, 0.04370357, -0.8573577)).norm(), 1e-6);
  EXPECT_NEAR(body.mean_error_m, 0.0005152203, 1e-9);
  EXPECT_EQ(frame.exposure_ticks, 1416497730518U);
  EXPECT_EQ(frame.sent_ticks, 1416497748722U);
  // A marker is hidden, the body is not lost.
  ASSERT_TRUE(natnet::parse_frame(bytes_of(natnet_occluded_frame), three, frame));
  ASSERT_EQ(frame.bodies.size(), 1U);
  EXPECT_EQ(frame.number, 269007U);
  EXPECT_EQ(frame.bodies[0].id, 7);
  EXPECT_TRUE(frame.bodies[0].tracked);
  EXPECT_LT((frame.bodies[0].p_W_m - Vec3(-0.15413156, 0.28294480, 0.47066432)).norm(), 1e-6);
  EXPECT_GT(frame.exposure_ticks, 0U);
}

// In a table one number that is none would make all others unreadable.
TEST(NatNet, APoseThatIsNoneIsNotTracked) {
  EmulatedFrame whole;
  whole.p[1] = 0.5F;
  const auto body_of = [](const EmulatedFrame& f) {
    natnet::Frame frame;
    EXPECT_TRUE(natnet::parse_frame(bytes_of(natnet_frame_packet(f, false)), three, frame));
    return frame.bodies.at(0);
  };
  EXPECT_TRUE(body_of(whole).tracked);
  auto nowhere = whole;
  nowhere.p[2] = std::numeric_limits<float>::quiet_NaN();
  auto no_rotation = whole;
  no_rotation.q_xyzw[3] = 0.0F;
  auto endless = whole;
  endless.q_xyzw[0] = std::numeric_limits<float>::infinity();
  for (const auto& f : {nowhere, no_rotation, endless}) {
    const natnet::Body body = body_of(f);
    EXPECT_FALSE(body.tracked);
    EXPECT_EQ(body.p_W_m, Vec3::Zero());
    EXPECT_EQ(body.q_WB.coeffs(), Quat::Identity().coeffs());
  }
}

TEST(NatNetCaptured, BodiesHaveNames) {
  const auto bodies = natnet::parse_descriptions(bytes_of(natnet_descriptions), three);
  ASSERT_TRUE(bodies);
  EXPECT_THAT(*bodies, ElementsAre(Pair("RaceQuad", 2)));
}

TEST(NatNetCaptured, RequestsAreThoseOfOptiTracksClient) {
  const auto connect = text_of(natnet_connect);
  const auto ours = natnet::connect_request();
  ASSERT_EQ(ours.size(), connect.size());
  EXPECT_EQ(ours.substr(0, 4), connect.substr(0, 4));
  EXPECT_EQ(ours.substr(260), connect.substr(260)) << "the versions";
  EXPECT_EQ(natnet::empty_message(natnet::Message::request_descriptions), text_of(natnet_request_descriptions));
}

// The emulator, made from the values of the captured frame, sends the captured frame.
TEST(NatNetCaptured, TheEmulatorsFrameIsMotives) {
  EmulatedFrame f;
  f.number = 162734;
  f.body = 2;
  const float p[3] = {0.17444664239883423F, 1.4471313953399658F, -0.7343040108680725F};
  const float q[4] = {-0.05459423363208771F, 0.509948194026947F, 0.04370357096195221F, -0.8573576807975769F};
  std::copy(p, p + 3, f.p);
  std::copy(q, q + 4, f.q_xyzw);
  f.mean_error = 0.0005152203375473619F;
  f.markers = {{1,
                2,
                {0.12721621990203857F, 1.5050275325775146F, -0.8858283758163452F},
                0.021439820528030396F,
                0.00020748283714056015F,
                10},
               {2,
                2,
                {0.20898520946502686F, 1.4832806587219238F, -0.7121866345405579F},
                0.020884789526462555F,
                0.000539067666977644F,
                10},
               {3,
                2,
                {-0.04574164003133774F, 1.4310429096221924F, -0.8313022255897522F},
                0.020809074863791466F,
                0.000689117528963834F,
                10},
               {4,
                2,
                {0.18133828043937683F, 1.4358338117599487F, -0.6535942554473877F},
                0.019269507378339767F,
                0.0003837273397948593F,
                10},
               {5,
                2,
                {0.32139891386032104F, 1.4146512746810913F, -0.7529537677764893F},
                0.021224740892648697F,
                0.0006357387755997479F,
                10},
               {50007,
                0,
                {0.17081165313720703F, 1.5076590776443481F, -0.840234637260437F},
                0.0201573446393013F,
                0.0005593782989308238F,
                18}};
  f.time_s = 1356.1166666666666;
  f.exposure = 1416497730518;
  f.received = 1416497745808;
  f.sent = 1416497748722;
  EXPECT_EQ(natnet_frame_packet(f, false), text_of(natnet_frame));
}

EmulatedPose circle(double t) {
  return {Vec3(0.1 * std::cos(t), 0.1 * std::sin(t), 0.3), Quat(Eigen::AngleAxisd(0.2 * t, Vec3::UnitY())), true};
}

std::vector<PoseSample> read_for(PoseSource& source, double seconds) {
  MonotonicClock clock;
  std::vector<PoseSample> all, some(64);
  const double until = clock.now_s() + seconds;
  while (clock.now_s() < until) {
    const auto n = source.read(some, until);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

class NatNetVersions : public ::testing::TestWithParam<bool> {};

TEST_P(NatNetVersions, PosesComeAtTheCamerasTimes) {
  NatNetEmulator motive(240.0, {}, circle, GetParam());
  const auto source = open_natnet({"127.0.0.1", motive.command_port(), "probe", 3.0, 240.0});
  EXPECT_TRUE(source->identity().emulated) << "it is on this machine";
  EXPECT_THAT(source->identity().firmware, HasSubstr("Motive"));
  EXPECT_EQ(source->ticks_per_s(), NatNetEmulator::ticks_per_s);
  source->start();
  const auto samples = read_for(*source, 1.0);
  source->stop();
  ASSERT_GT(samples.size(), 100U);
  EXPECT_EQ(source->counters().lost, 0U);
  EXPECT_EQ(source->counters().malformed, 0U);
  for (const auto& s : samples) {
    const auto truth = circle(static_cast<double>(s.ticks) / NatNetEmulator::ticks_per_s - NatNetEmulator::epoch_s);
    EXPECT_LT((s.p_W_m - truth.p_W_m).norm(), 1e-7);
    EXPECT_LT(s.q_WB.angularDistance(truth.q_WB), 1e-3);
    EXPECT_EQ(s.flags & recording::sample_not_tracked, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, NatNetVersions, ::testing::Values(false, true),
                         [](const auto& version) { return version.param ? "FourOne" : "Three"; });

TEST(NatNet, CountsWhatTheNetworkDoes) {
  NatNetFaults faults;
  faults.drop_every = 10;
  faults.repeat_every = 7;
  faults.short_every = 13;
  NatNetEmulator motive(1000.0, faults, circle);
  const auto source = open_natnet({"127.0.0.1", motive.command_port(), "", 3.0, 0.0});
  source->start();
  const auto samples = read_for(*source, 1.0);
  const auto c = source->counters();
  ASSERT_GT(samples.size(), 200U);
  std::uint64_t gaps = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) gaps += samples[i].sequence - samples[i - 1].sequence - 1;
  EXPECT_EQ(c.lost, gaps);
  // Of all frames each 10th is dropped and each 13th cut short.
  const auto sent = static_cast<double>(samples.size() + c.lost);
  EXPECT_NEAR(static_cast<double>(c.lost), sent * (1.0 / 10 + 1.0 / 13 - 1.0 / 130), 5.0);
  EXPECT_GT(c.repeated, 0U);
  EXPECT_GT(c.malformed, 0U);
}

// As from a computer with two network cards: nothing of it is taken, and nothing of it goes unsaid.
TEST(NatNet, CountsFramesFromAnotherAddress) {
  NatNetFaults faults;
  faults.second_card = true;
  NatNetEmulator motive(240.0, faults, circle);
  const auto source = open_natnet({"127.0.0.1", motive.command_port(), "probe", 3.0, 240.0});
  source->start();
  EXPECT_TRUE(read_for(*source, 0.5).empty());
  EXPECT_EQ(source->counters().received, 0U);
  EXPECT_GT(source->counters().foreign_packets, 50U);
}

// All that comes then would count as late, and the run would end as one whose stream stopped.
TEST(NatNet, NumbersThatBeginAgainAreSaid) {
  NatNetFaults faults;
  faults.begins_at = 5000;
  faults.begins_again = 750;
  NatNetEmulator motive(500.0, faults, circle);
  const auto source = open_natnet({"127.0.0.1", motive.command_port(), "2", 3.0, 0.0});
  source->start();
  try {
    read_for(*source, 6.0);
    ADD_FAILURE() << "went on";
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("was Motive restarted"));
  }
}

TEST(NatNet, ALostBodyIsFlaggedNotGuessed) {
  NatNetEmulator motive(240.0, {}, [](double t) {
    auto pose = circle(t);
    pose.tracked = false;
    return pose;
  });
  const auto source = open_natnet({"127.0.0.1", motive.command_port(), "2", 3.0, 0.0});
  source->start();
  const auto samples = read_for(*source, 0.3);
  ASSERT_FALSE(samples.empty());
  for (const auto& s : samples) EXPECT_NE(s.flags & recording::sample_not_tracked, 0U);
}

TEST(NatNet, SaysWhichBodiesThereAreAndWhenNobodyAnswers) {
  const auto complaint = [](const NatNetOptions& options) -> std::string {
    try {
      open_natnet(options);
    } catch (const DeviceError& error) {
      return error.what();
    }
    return "opened";
  };
  int port = 0;
  {
    NatNetEmulator motive(60.0, {}, circle);
    port = motive.command_port();
    EXPECT_THAT(complaint({"127.0.0.1", port, "stylus", 1.0, 0.0}), HasSubstr("no rigid body \"stylus\"; it has"));
    EXPECT_THAT(complaint({"127.0.0.1", port, "99999999999", 1.0, 0.0}), HasSubstr("no rigid body 99999999999;"));
  }
  EXPECT_THAT(complaint({"127.0.0.1", port, "probe", 0.3, 0.0}), HasSubstr("is Motive streaming"));
}

// A packet of any kind, cut anywhere or with any byte changed, is read or refused and nothing else.
TEST(NatNet, DamagedPacketsAreReadOrRefused) {
  EmulatedFrame f;
  f.markers.resize(4);
  Random random(77);
  natnet::Frame frame;
  for (const bool sized : {false, true}) {
    const auto whole = natnet_frame_packet(f, sized);
    const natnet::Version version = sized ? natnet::Version{4, 1} : three;
    EXPECT_TRUE(natnet::parse_frame(bytes_of(whole), version, frame));
    for (int trial = 0; trial < 20000; ++trial) {
      std::string damaged = whole.substr(0, random.below(2) == 0 ? whole.size() : random.below(whole.size()));
      for (int k = 0; k < 3 && !damaged.empty(); ++k)
        damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
      if (natnet::parse_frame(bytes_of(damaged), version, frame)) {
        EXPECT_LE(frame.bodies.size(), 10000U);
      }
      natnet::parse_descriptions(bytes_of(damaged), version);
      natnet::parse_server_info(bytes_of(damaged));
    }
  }
}

}  // namespace
}  // namespace touchstone::hil
