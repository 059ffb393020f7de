#include "harness/recording/tool_load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::recording {
namespace {

using ::testing::HasSubstr;
const Vec3 gravity(0, 0, -9.81);
constexpr std::uint64_t seed = 20260101;

ToolLoad tool_of(double mass, double scale) {
  ToolLoad load;
  load.mass_kg = mass;
  load.center_S_m = scale * Vec3(1.5, -2.0, 24.0);
  load.bias = {mass * Vec3(3.0, -1.0, 8.0), mass * scale * Vec3(-2.0, 0.5, 1.0)};
  return load;
}

std::vector<StaticPose> poses_of(const ToolLoad& load, int n, double force_noise, double torque_noise, double tilt,
                                 Random& random) {
  std::vector<StaticPose> poses;
  for (int i = 0; i < n; ++i) {
    StaticPose pose;
    pose.q_WS = random.rotation();
    pose.measured = tool_wrench(load, pose.q_WS, gravity);
    for (int k = 0; k < 3; ++k)
      pose.measured.f_N[k] += force_noise * random.normal(),
          pose.measured.torque_Nm[k] += torque_noise * random.normal();
    pose.q_WS = (pose.q_WS * Quat(Eigen::AngleAxisd(tilt * random.normal(), random.direction()))).normalized();
    poses.push_back(pose);
  }
  return poses;
}

TEST(ToolLoad, IsFoundExactlyFromExactPosesAtEveryScale) {
  Random random(seed);
  for (const double mass : {1e-3, 0.03, 1.0, 1e3}) {
    for (const double scale : {1e-6, 1e-3, 1.0}) {
      const ToolLoad truth = tool_of(mass, scale);
      const auto found = identify_tool(poses_of(truth, 6, 0, 0, 0, random), gravity, "poses.csv");
      EXPECT_NEAR(found.load.mass_kg / mass, 1.0, 1e-12);
      EXPECT_LT((found.load.center_S_m - truth.center_S_m).norm(), 1e-11 * truth.center_S_m.norm());
      EXPECT_LT((found.load.bias.f_N - truth.bias.f_N).norm(), 1e-11 * truth.bias.f_N.norm());
      EXPECT_LT((found.load.bias.torque_Nm - truth.bias.torque_Nm).norm(),
                3e-12 * mass * 9.81 * truth.center_S_m.norm());
      EXPECT_LT(found.fit.force_vector_N, 1e-12 * mass * 9.81);
      EXPECT_LT(found.held_out.force_vector_N, 1e-11 * mass * 9.81);
      EXPECT_EQ(found.held_out.samples, 6U);
    }
  }
}

TEST(ToolLoad, ThreeDirectionsOfGravityAreNeeded) {
  Random random(seed + 1);
  const ToolLoad truth = tool_of(0.03, 1e-3);
  const auto many = poses_of(truth, 8, 0, 0, 0, random);
  const auto complaint = [&](const std::vector<StaticPose>& poses) {
    try {
      identify_tool(poses, gravity, "poses.csv");
      return std::string("accepted");
    } catch (const BadData& error) {
      return std::string(error.what());
    }
  };
  EXPECT_THAT(complaint({}), HasSubstr("no static orientations"));
  EXPECT_THAT(complaint({many[0]}), HasSubstr("determine only 6 of the 10"));
  EXPECT_THAT(complaint({many[0], many[1]}), HasSubstr("determine only 9 of the 10"));
  EXPECT_EQ(complaint({many[0], many[1], many[2]}), "accepted");
  // Turning about the vertical changes nothing that gravity shows.
  std::vector<StaticPose> yawed;
  for (int i = 0; i < 8; ++i) {
    StaticPose pose;
    pose.q_WS = Quat(Eigen::AngleAxisd(0.7 * i, Vec3::UnitZ())) * many[0].q_WS;
    pose.measured = tool_wrench(truth, pose.q_WS, gravity);
    yawed.push_back(pose);
  }
  EXPECT_THAT(complaint(yawed), HasSubstr("determine only 6 of the 10"));
}

// The numbers of a small probe: 30 g, 1/320 N, 1/64 N mm, a degree of tilt error. The stated uncertainty must cover the
// error as often as it says, neither much less nor much more.
TEST(ToolLoad, StatesItsUncertainty) {
  const ToolLoad truth = tool_of(0.03, 1e-3);
  for (const int n : {6, 24}) {
    int covered = 0;
    double worst_mass = 0.0, worst_center = 0.0, squared_mass = 0.0;
    constexpr int trials = 200;
    for (int trial = 0; trial < trials; ++trial) {
      Random random(seed + 100 + static_cast<std::uint64_t>(trial));
      const auto found =
          identify_tool(poses_of(truth, n, 1.0 / 320, 1.0 / 64 * 1e-3, 0.0, random), gravity, "poses.csv");
      const double error = std::abs(found.load.mass_kg - truth.mass_kg);
      covered += error < 2 * found.mass_sigma_kg;
      worst_mass = std::max(worst_mass, error / truth.mass_kg);
      squared_mass += std::pow(error / truth.mass_kg, 2) / trials;
      worst_center = std::max(worst_center, (found.load.center_S_m - truth.center_S_m).norm());
    }
    RecordProperty("rms_mass_error_percent_" + std::to_string(n), std::to_string(100 * std::sqrt(squared_mass)));
    EXPECT_GT(covered, trials * 90 / 100) << n;  // two sigmas: 95 % of them
    EXPECT_LT(covered, trials) << "an uncertainty that always covers is too wide";
    EXPECT_LT(worst_mass, n == 6 ? 0.03 : 0.015);
    EXPECT_LT(worst_center, n == 6 ? 2e-3 : 1e-3);
  }
}

// The closed form against what it stands for: each pose predicted from a fit to all others.
TEST(ToolLoad, HeldOutIsTheFitToTheOthers) {
  Random random(seed + 3);
  const auto poses = poses_of(tool_of(0.4, 2e-3), 9, 0.02, 4e-4, 0.01, random);
  std::vector<Wrench> left;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    auto others = poses;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Wrench expected = tool_wrench(identify_tool(others, gravity, "poses.csv").load, poses[i].q_WS, gravity);
    left.push_back({poses[i].measured.f_N - expected.f_N, poses[i].measured.torque_Nm - expected.torque_Nm});
  }
  const WrenchResidual others = residual_of(left), closed = identify_tool(poses, gravity, "poses.csv").held_out;
  EXPECT_EQ(closed.samples, poses.size());
  EXPECT_NEAR(closed.force_component_N, others.force_component_N, 1e-11);
  EXPECT_NEAR(closed.torque_component_Nm, others.torque_component_Nm, 1e-13);
  // Of three orientations none can be left out.
  EXPECT_EQ(identify_tool({poses[0], poses[1], poses[2]}, gravity, "poses.csv").held_out.samples, 0U);
}

TEST(ToolLoad, CompensationLeavesTheContactAndMovesTheTorqueToTheTip) {
  Random random(seed + 2);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const ToolLoad load = tool_of(0.03 * scale, 1e-3 * scale);
    const Vec3 tip = 0.05 * scale * Vec3(0.1, -0.2, 1.0);
    const Quat q = random.rotation();
    const Vec3 contact = scale * random.direction();
    Wrench measured = tool_wrench(load, q, gravity);
    measured.f_N += contact;
    measured.torque_Nm += tip.cross(contact);
    const Wrench at_tip = contact_wrench_at_tip(measured, load, q, gravity, tip);
    EXPECT_LT((at_tip.f_N - contact).norm(), 1e-13 * measured.f_N.norm());
    EXPECT_LT(at_tip.torque_Nm.norm(), 1e-13 * (measured.torque_Nm.norm() + tip.norm() * measured.f_N.norm()));
  }
}

}  // namespace
}  // namespace touchstone::recording
