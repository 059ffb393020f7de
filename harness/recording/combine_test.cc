#include "harness/recording/combine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

Vec3 position(double t) { return {0.05 * std::sin(2.0 * t), 0.02 * std::cos(3.0 * t), 0.01 * t}; }
Vec3 slow_force(double t) { return {std::sin(2.0 * t), 2.0, -0.5 * t}; }

// A 60 Hz tracker and a 5 kHz force sensor; 1 N of 450 Hz vibration on top, which would alias to 30 Hz.
MotionColumns tracker(double from_s, double to_s) {
  MotionColumns pose;
  for (const double t : uniform_times(from_s, to_s, 60.0)) {
    pose.t_s.push_back(t);
    pose.p_W_m.push_back(position(t));
    pose.q_WS.emplace_back(Eigen::AngleAxisd(t, Vec3::UnitX()));
  }
  return pose;
}

ForceColumns sensor(double from_s, double to_s) {
  ForceColumns force;
  for (const double t : uniform_times(from_s, to_s, 5000.0)) {
    force.t_s.push_back(t);
    force.f_W_N.emplace_back(slow_force(t) + Vec3::UnitZ() * std::sin(2.0 * std::numbers::pi * 450.0 * t));
    force.torque_W_Nm.emplace_back(0.1 * slow_force(t));
  }
  return force;
}

TEST(Combine, OnTheTrackersTimesVibrationDoesNotAlias) {
  const Combined combined = combine(tracker(0.0, 2.0), sensor(0.5, 1.5));
  const Recording& recording = combined.recording;
  ASSERT_EQ(recording.size(), 61U);
  EXPECT_EQ(recording.torque_W_Nm.size(), 61U);
  EXPECT_EQ(recording.motion.q_WS.size(), 61U);
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double t = recording.motion.t_s[i];
    EXPECT_EQ(recording.motion.p_W_m[i], position(t)) << "its own times are left alone";
    // Beside the ends the window is one-sided and takes out less.
    const bool inside = t > 0.5 + 1.0 / 60.0 && t < 1.5 - 1.0 / 60.0;
    EXPECT_LE((recording.f_W_N[i] - slow_force(t)).norm(), inside ? 2e-3 : 0.25) << t;
  }
  EXPECT_THAT(combined.notes, Contains(HasSubstr("force: 5000 Hz to 60 Hz by local linear average")));
}

TEST(Combine, OnTheSensorsTimesPositionIsCubic) {
  const Combined combined = combine(tracker(0.0, 2.0), sensor(0.5, 1.5), {.times = CommonTimes::force});
  const Recording& recording = combined.recording;
  ASSERT_EQ(recording.size(), 5001U);
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double t = recording.motion.t_s[i];
    // (3/128) h^4 max|p''''| with p'''' up to 0.05 2^4 + 0.02 3^4.
    EXPECT_LE((recording.motion.p_W_m[i] - position(t)).norm(), 3.0 / 128.0 * std::pow(60.0, -4) * 2.42 + 1e-15);
    EXPECT_LE(recording.motion.q_WS[i].angularDistance(Quat(Eigen::AngleAxisd(t, Vec3::UnitX()))), 1e-7);
  }
  EXPECT_THAT(combined.notes, Contains(HasSubstr("position: 60 Hz to 5000 Hz by cubic")));
}

TEST(Combine, GapsAreLeftOutAndSaidOrRefused) {
  MotionColumns pose = tracker(0.0, 1.0);
  const MotionColumns later = tracker(2.0, 3.0);
  pose.t_s.insert(pose.t_s.end(), later.t_s.begin(), later.t_s.end());
  pose.p_W_m.insert(pose.p_W_m.end(), later.p_W_m.begin(), later.p_W_m.end());
  pose.q_WS.insert(pose.q_WS.end(), later.q_WS.begin(), later.q_WS.end());
  const CombineOptions options{.times = CommonTimes::uniform, .rate_Hz = 1000.0};
  const Combined combined = combine(pose, sensor(0.0, 3.0), options);
  for (const double t : combined.recording.motion.t_s) EXPECT_TRUE(t <= 1.0 + 1e-12 || t >= 2.0 - 1e-12) << t;
  EXPECT_THAT(combined.notes, Contains(HasSubstr("samples left out: they lie in a gap")));
  CombineOptions strict = options;
  strict.on_gap = OnGap::refuse;
  EXPECT_THROW(combine(pose, sensor(0.0, 3.0), strict), BadData);
}

TEST(Combine, ClocksThatDoNotOverlapAreRefused) {
  EXPECT_THROW(combine(tracker(0.0, 1.0), sensor(2.0, 3.0)), BadData);
  EXPECT_THROW(combine(tracker(0.0, 1.0), ForceColumns{}), BadData);
}

}  // namespace
}  // namespace touchstone::recording
