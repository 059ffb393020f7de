// Sessions that break one assumption of the acquisition, by a simulator of its own: refused or right, never silent.
#include "session_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "pose_faults.h"
#include "simulated_sessions_for_test.h"

namespace touchstone::acquisition {
namespace {

using ::testing::HasSubstr;

TEST(SessionCheck, UndisturbedSessionsPassAndAreRight) {
  const Outcomes all = acquire_all(8101, 4, std::array{Disturbance::none});
  EXPECT_EQ(all.refused, 0);
  EXPECT_EQ(all.wrong, 0);
}

// Contacts must not cost what the markers know, also where a soft surface gives in and hardly tells a shift along it.
TEST(SessionCheck, ContactsMakeARegistrationByMarkersNoWorse) {
  double with2 = 0.0, without2 = 0.0;
  for (std::uint64_t seed = 8301; seed < 8309; ++seed) {
    const Outcome with = acquire_simulated(seed, Disturbance::none),
                  without = acquire_simulated(seed, Disturbance::none, false);
    ASSERT_FALSE(with.refused) << with.sentence;
    ASSERT_FALSE(without.refused) << without.sentence;
    with2 += with.position_rms_m * with.position_rms_m;
    without2 += without.position_rms_m * without.position_rms_m;
  }
  EXPECT_LT(with2, without2);
}

// Both change the gaps by 0.2 mm and less: the scan's error without a move, and a slide by 3 mm along a nearly level
// surface without a scan error.
TEST(SessionCheck, AMoveAlongTheSurfaceIsToldFromTheScansError) {
  const Outcome rough = acquire_simulated(8401, Disturbance::none, true, 0.2e-3);
  EXPECT_FALSE(rough.refused) << rough.sentence;
  const Outcome moved = acquire_simulated(9528, Disturbance::moved_object);
  EXPECT_TRUE(moved.refused);
  EXPECT_THAT(moved.sentence, HasSubstr("the object moved against the tracker around"));
}

TEST(SessionCheck, EachDisturbanceIsNamedWithTheNextStep) {
  const auto said = [](Disturbance kind) { return acquire_simulated(8202, kind).sentence; };
  EXPECT_THAT(said(Disturbance::knock_at_start), HasSubstr("/force/bias_from_s"));
  EXPECT_THAT(said(Disturbance::knock_half_way), HasSubstr("the force's bias moved by"));
  EXPECT_THAT(said(Disturbance::bias_drift), HasSubstr("the force's bias moved by"));
  EXPECT_THAT(said(Disturbance::held_poses), HasSubstr("repeated its last pose while the probe moved on"));
  EXPECT_THAT(said(Disturbance::swapped_markers), HasSubstr("jumped there and back faster than a hand"));
  EXPECT_THAT(said(Disturbance::moved_object), HasSubstr("the object moved against the tracker"));
  EXPECT_THAT(said(Disturbance::wrong_tip), HasSubstr("/probe/tip_P_m"));
  EXPECT_THAT(said(Disturbance::wrong_lever), HasSubstr("/probe/tip_S_m"));
  EXPECT_THAT(said(Disturbance::turned_sensor), HasSubstr("/probe/q_PS"));
  EXPECT_THAT(said(Disturbance::reversed_statics), HasSubstr("--flip-force"));
  EXPECT_THAT(said(Disturbance::cable), HasSubstr("does a cable or a hose pull at the tool"));
  EXPECT_THAT(said(Disturbance::gain), HasSubstr("the gains of the force's axes do not agree"));
}

// Static poses say nothing of it; free air does where the tool's weight is along the axis, and sliding contact.
TEST(SessionCheck, AGainThatChangesAfterTheStaticPosesIsNeverSilent) {
  int by_sliding = 0;
  for (std::uint64_t seed = 8501; seed < 8507; ++seed) {
    const Outcome outcome = acquire_simulated(seed, Disturbance::later_gain);
    const bool said = outcome.sentence.find("whether the force's axes still have one gain") != std::string::npos;
    EXPECT_TRUE(outcome.refused || said || outcome.right()) << seed << ": " << outcome.force_rms_N << " N";
    by_sliding += said;
  }
  EXPECT_GT(by_sliding, 0);
}

// Places along z at 60 Hz, a hundred at rest and then these steps [mm].
PoseFaults faults_of_steps(const std::vector<double>& steps_mm) {
  std::vector<double> t_s;
  std::vector<Vec3> tip_m;
  double z_mm = 0.0;
  const auto place = [&] {
    const auto i = static_cast<double>(t_s.size());
    t_s.push_back(i / 60.0);
    tip_m.push_back(1e-3 * Vec3(0.02 * std::sin(37.0 * i), 0.02 * std::sin(53.0 * i), z_mm));
  };
  for (int i = 0; i < 100; ++i) place();
  for (const double step : steps_mm) z_mm += step, place();
  return find_pose_faults(t_s, tip_m, std::vector<Quat>(t_s.size(), Quat::Identity()));
}

// A tap at 0.28 m/s that bounces back once within a frame, and as large a step out of rest, there and back.
TEST(PoseFaults, ATapThatBouncesIsNoJump) {
  EXPECT_FALSE(
      faults_of_steps({0.4, -0.3, 1.8, 2.6, 3.6, 4.7, 4.1, 0.5, -1.5, 0.5, 0.4, -0.4, 0.3, 0.5, -0.4, 0.2}).any());
  const auto swapped =
      faults_of_steps({0.4, -0.3, 0.2, 0.3, -0.2, 5.0, 0.1, 0.3, -5.2, 0.2, 0.3, -0.4, 0.3, 0.5, -0.4});
  EXPECT_EQ(swapped.swapped.size(), 1U);
  EXPECT_TRUE(swapped.jumped.empty());
}

}  // namespace
}  // namespace touchstone::acquisition
