// Poses of a tool whose sensor has wrong gains are made from the gains, and must lead back to them.
#include "force_gains.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/random.h"

namespace touchstone::acquisition {
namespace {

using testing::HasSubstr;
const Vec3 gravity(0, 0, -9.81);

std::vector<StaticPose> poses_of(double mass_kg, const Mat3& gains, double noise_N, int count, Random& random) {
  std::vector<StaticPose> poses;
  for (int i = 0; i < count; ++i) {
    StaticPose pose;
    pose.q_WS = random.rotation();
    pose.measured.f_N = gains * (mass_kg * (pose.q_WS.conjugate() * gravity) + Vec3(1.0, -2.0, 0.5));
    for (int k = 0; k < 3; ++k) pose.measured.f_N[k] += noise_N * random.normal();
    poses.push_back(pose);
  }
  return poses;
}

const std::vector<Vec3> push{{0.4, -0.3, 2.0}, {-0.2, 0.5, 1.6}, {0.1, 0.1, 1.2}};

// sqrt(mean |(C / c - 1) f|^2) of the forces that were measured, f = C f_true.
double error_by(const Mat3& gains, double right_one) {
  double sum2 = 0.0;
  for (const Vec3& f : push) sum2 += ((gains / right_one - Mat3::Identity()) * f).squaredNorm() / 3.0;
  return std::sqrt(sum2);
}

TEST(ForceGains, AreFoundExactlyFromExactPosesAtEveryScale) {
  Random random(4401);
  for (const double mass_kg : {1e-3, 0.1, 10.0}) {
    Mat3 gains = Vec3(1.0, 1.0, 1.25).asDiagonal();
    gains(0, 2) = 0.02;
    const ForceGains found = identify_gains(poses_of(mass_kg, gains, 0.0, 5, random), gravity);
    ASSERT_TRUE(found.determined);
    EXPECT_LT((found.mass_kg / mass_kg - gains).norm(), 1e-9);
    EXPECT_LT((found.gains(std::nullopt) - Vec3(1.0, 1.0, 1.25)).norm(), 1e-9);
    // By the balance x and y are right, so that z is wrong by a quarter.
    const GainError weighed = gain_error(found, push, 0.4, mass_kg);
    EXPECT_NEAR(weighed.error_N, error_by(gains, 1.0), 1e-9);
    EXPECT_THAT(weighed.fault, HasSubstr("1.000, 1.000 and 1.250"));
  }
}

// Two axes too large by a quarter, or one too small by a fifth: poses do not tell which, and the worse one counts.
TEST(ForceGains, WithoutAWeighedMassAnyAxisMayBeTheRightOne) {
  Random random(4402);
  for (const Vec3& gains : {Vec3(1.0, 1.0, 1.25), Vec3(1.25, 1.0, 1.0)}) {
    const Mat3 matrix = gains.asDiagonal();
    const GainError error = gain_error(identify_gains(poses_of(0.2, matrix, 0.0, 8, random), gravity), push, 0.4, {});
    EXPECT_NEAR(error.error_N, std::max(error_by(matrix, 1.0), error_by(matrix, 1.25)), 1e-9);
    EXPECT_FALSE(error.fault.empty());
  }
}

// What all axes share shows if the tool was weighed, and only then.
TEST(ForceGains, ACommonGainNeedsABalance) {
  Random random(4403);
  const ForceGains found = identify_gains(poses_of(0.2, 1.2 * Mat3::Identity(), 0.0, 8, random), gravity);
  EXPECT_NEAR(gain_error(found, push, 0.4, {}).error_N, 0.0, 1e-9);
  EXPECT_FALSE(gain_error(found, push, 0.4, 0.2).fault.empty());
}

// Equal gains are not accused, and the stated interval of the error reaches down to nothing, in all but one of 200.
TEST(ForceGains, NoiseIsNoGain) {
  Random random(4404);
  int accused = 0, doubted = 0;
  for (int i = 0; i < 200; ++i) {
    const ForceGains found = identify_gains(poses_of(0.1, Mat3::Identity(), 3e-3, 9, random), gravity);
    const GainError error = gain_error(found, push, 0.4, {});
    accused += !error.fault.empty(), doubted += !error.doubt.empty();
    EXPECT_GT(error.sigma_N, 0.0);
  }
  EXPECT_EQ(accused, 0);
  EXPECT_LE(doubted, 1);
}

TEST(ForceGains, WhatPosesDoNotTellIsDoubted) {
  Random random(4405);
  const auto doubt = [&](const std::vector<StaticPose>& poses) {
    const GainError error = gain_error(identify_gains(poses, gravity), push, 0.4, {});
    EXPECT_TRUE(error.fault.empty()) << error.fault;
    return error.doubt;
  };
  // A tool of 2 g, a weight of six times the noise; four poses; poses about one axis.
  EXPECT_THAT(doubt(poses_of(2e-3, Mat3::Identity(), 3e-3, 9, random)), HasSubstr("cannot tell"));
  EXPECT_THAT(doubt(poses_of(0.1, Mat3::Identity(), 3e-3, 4, random)), HasSubstr("4 static poses do not determine"));
  std::vector<StaticPose> level = poses_of(0.1, Mat3::Identity(), 3e-3, 9, random);
  for (StaticPose& pose : level) pose.q_WS = Quat(Eigen::AngleAxisd(random.uniform(0.0, 6.28), Vec3::UnitX()));
  EXPECT_THAT(doubt(level), HasSubstr("9 static poses do not determine"));
}

}  // namespace
}  // namespace touchstone::acquisition
