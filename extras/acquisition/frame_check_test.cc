// Poses of a made tool, written with each mistake: the check names the mistake, and good poses are not blamed. One real
// set: an ATI Axia80 whose wrench its publisher had turned into the world's frame.
#include "frame_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "acquire.h"
#include "harness/base/random.h"
#include "harness/base/signed_order.h"
#include "harness/testing/shared_data.h"

namespace touchstone::acquisition {
using recording::ToolLoad;
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
const Vec3 standard_gravity(0, 0, -9.80665);

std::vector<StaticPose> made_poses(double mass_kg, double noise_N, int count, Random& random) {
  ToolLoad load;
  load.mass_kg = mass_kg;
  load.center_S_m = Vec3(0.003, -0.002, 0.05);
  load.bias = {mass_kg * Vec3(0.8, -0.4, 1.2), mass_kg * Vec3(0.01, 0.0, -0.02)};
  std::vector<StaticPose> poses;
  for (int i = 0; i < count; ++i) {
    StaticPose pose;
    pose.q_WS = random.rotation();
    pose.measured = recording::tool_wrench(load, pose.q_WS, standard_gravity);
    for (int k = 0; k < 3; ++k) pose.measured.f_N[k] += noise_N * random.normal();
    poses.push_back(pose);
  }
  return poses;
}

// Writes the poses with a mistake, so that reading them with `reading` undoes it.
std::vector<StaticPose> written_wrongly(std::vector<StaticPose> poses, const PoseReading& reading) {
  for (StaticPose& pose : poses) {
    const double sign = reading.flip_force ? -1.0 : 1.0;
    const Quat turn = reading.wrench == WrenchFrame::world ? pose.q_WS : Quat::Identity();
    pose.measured = {sign * (turn * pose.measured.f_N), sign * (turn * pose.measured.torque_Nm)};
    const Quat q = pose.q_WS;
    if (reading.orientation == OrientationReading::inverse) pose.q_WS = q.conjugate();
    if (reading.orientation == OrientationReading::scalar_last) pose.q_WS = Quat(q.x(), q.y(), q.z(), q.w());
  }
  return poses;
}

TEST(FrameCheck, NamesEveryMistakeAndItsRepair) {
  Random random(20260102);
  using enum OrientationReading;
  int cases = 0;
  for (const double mass_kg : {0.02, 1.0, 50.0}) {
    for (const bool flip : {false, true}) {
      for (const auto orientation : {given, inverse, scalar_last}) {
        for (const auto frame : {WrenchFrame::sensor, WrenchFrame::world}) {
          const PoseReading mistake{frame, orientation, flip};
          const auto truth = made_poses(mass_kg, 0.005 * mass_kg, 30, random);
          const auto poses = written_wrongly(truth, mistake);
          // Writing and reading undo one another.
          const auto again = read_as(poses, mistake);
          for (std::size_t i = 0; i < truth.size(); ++i) {
            EXPECT_LT((again[i].measured.f_N - truth[i].measured.f_N).norm(), 1e-12 * mass_kg * 9.81);
          }
          const auto as_read = recording::identify_tool(poses, standard_gravity, "poses.csv");
          const auto check = check_frames(poses, {}, as_read, standard_gravity, "poses.csv");
          if (mistake.flags().empty()) {
            EXPECT_FALSE(check.bad_fit);
            EXPECT_EQ(check.message(as_read, "poses.csv"), "");
            continue;
          }
          ++cases;
          ASSERT_TRUE(check.bad_fit) << mistake.flags();
          ASSERT_TRUE(check.repair) << mistake.flags();
          EXPECT_EQ(check.repair->flags(), mistake.flags());
          EXPECT_NEAR(check.repaired.load.mass_kg, mass_kg, 0.01 * mass_kg);
          EXPECT_THAT(check.message(as_read, "poses.csv"), HasSubstr(mistake.flags()));
        }
      }
    }
  }
  EXPECT_EQ(cases, 33);
}

TEST(FrameCheck, NamesAxesThatAreMirroredOrExchanged) {
  Random random(20260103);
  for (const auto& [order, said] :
       {std::pair{SignedOrder{{0, 1, 2}, {1, -1, 1}}, "fy has the other sign"},
        {SignedOrder{{2, 1, 0}, {1, 1, 1}}, "fx and fz are exchanged"},
        {SignedOrder{{1, 2, 0}, {1, 1, 1}}, "the columns fx, fy, fz hold fz, fx, fy"},
        {SignedOrder{{1, 0, 2}, {1, 1, -1}}, "fx and fy are exchanged and fz has the other sign"}}) {
    auto poses = made_poses(0.35, 0.004, 40, random);
    // Written so that the order undoes it.
    for (StaticPose& pose : poses) {
      const Vec3 right = pose.measured.f_N;
      for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        pose.measured.f_N[order.from[at]] = order.sign[at] * right[k];
      }
    }
    const auto as_read = recording::identify_tool(poses, standard_gravity, "poses.csv");
    const auto check = check_frames(poses, {}, as_read, standard_gravity, "poses.csv");
    ASSERT_TRUE(check.bad_fit) << said;
    EXPECT_EQ(check.axes, said);
    EXPECT_NEAR(check.axes_mass_kg, 0.35, 0.002) << said;
    EXPECT_NEAR(check.axes_left_N, 0.004, 0.001) << said;
    EXPECT_THAT(check.message(as_read, "poses.csv"), HasSubstr(said));
  }
}

TEST(FrameCheck, NamesGainsThatDifferByMoreThanAFitLeaves) {
  Random random(20260106);
  for (int axis = 0; axis < 3; ++axis) {
    auto poses = made_poses(0.4, 0.002, 10, random);
    for (StaticPose& pose : poses) pose.measured.f_N[axis] *= 1.4;
    const auto as_read = recording::identify_tool(poses, standard_gravity, "poses.csv");
    const auto check = check_frames(poses, {}, as_read, standard_gravity, "poses.csv");
    ASSERT_TRUE(check.bad_fit);
    ASSERT_TRUE(check.gains);
    EXPECT_NEAR(check.gains->gains(std::nullopt)[axis], 1.4, 0.01);
    EXPECT_THAT(check.message(as_read, "poses.csv"), HasSubstr("with a gain for each of x, y and z"));
    EXPECT_TRUE(check.forces_fit());
    EXPECT_THAT(tool_text(as_read, *check.gains, true), HasSubstr("of the middle one (+- "));
  }
}

// Forces alone say nothing of the torque's columns: a wrong one gives a tool of the right mass with its centre
// elsewhere.
TEST(FrameCheck, NamesTheTorquesAxesAndItsReverseAsOne) {
  Random random(20260104);
  for (const SignedOrder& order : signed_orders()) {
    auto poses = made_poses(0.4, 0.002, 24, random);
    for (StaticPose& pose : poses) {
      Vec3 right = pose.measured.torque_Nm;
      for (int k = 0; k < 3; ++k) right[k] += 5e-5 * random.normal();
      for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        pose.measured.torque_Nm[order.from[at]] = order.sign[at] * right[k];
      }
    }
    const auto as_read = recording::identify_tool(poses, standard_gravity, "poses.csv");
    const auto check = check_frames(poses, {}, as_read, standard_gravity, "poses.csv");
    if (order.as_it_stands() || order.reversed()) {
      EXPECT_FALSE(check.bad_fit);
      continue;
    }
    const SignedOrder reverse{order.from, {-order.sign[0], -order.sign[1], -order.sign[2]}};
    ASSERT_TRUE(check.bad_fit) << order.meaning('t');
    EXPECT_THAT(check.torque_axes, ::testing::AnyOf(order.meaning('t'), reverse.meaning('t')));
    EXPECT_NEAR(check.torque_left_Nm, 5e-5, 2e-5);
    EXPECT_THAT(check.message(as_read, "poses.csv"), HasSubstr("if " + check.torque_axes));
    EXPECT_TRUE(check.forces_fit()) << "of the torques nothing is said here";
  }
}

// A tool whose centre of mass is at the sensor's origin has torques of noise alone, which no order explains better.
TEST(FrameCheck, TorquesOfNoiseAccuseNoAxis) {
  Random random(20260105);
  for (int trial = 0; trial < 500; ++trial) {
    auto poses = made_poses(0.4, 0.002, 6 + trial % 20, random);
    for (StaticPose& pose : poses)
      pose.measured.torque_Nm = 1e-3 * Vec3(random.normal(), random.normal(), random.normal());
    const auto as_read = recording::identify_tool(poses, standard_gravity, "poses.csv");
    EXPECT_EQ(check_frames(poses, {}, as_read, standard_gravity, "poses.csv").torque_axes, "");
  }
}

TEST(FrameCheck, PosesThatNothingExplainsAreABadFitWithoutRepair) {
  Random random(7);
  auto poses = made_poses(1.0, 0.01, 40, random);
  for (StaticPose& pose : poses) pose.q_WS = random.rotation();  // of other poses
  const auto as_read = recording::identify_tool(poses, standard_gravity, "mixed.csv");
  const auto check = check_frames(poses, {}, as_read, standard_gravity, "mixed.csv");
  EXPECT_TRUE(check.bad_fit);
  EXPECT_FALSE(check.gains);
  EXPECT_FALSE(check.repair);
  EXPECT_EQ(check.axes, "");
  EXPECT_THAT(check.message(as_read, "mixed.csv"), HasSubstr("mixed.csv: bad fit"));
  // Gains of forces that no tool explains are none, however sure the fit of twelve unknowns is of them.
  const ForceGains gains = identify_gains(poses, standard_gravity);
  ASSERT_TRUE(gains.determined);
  EXPECT_FALSE(check.forces_fit());
  EXPECT_THAT(tool_text(as_read, gains, check.forces_fit()),
              AllOf(HasSubstr("gains of the axes cannot tell: no tool fits the forces"), HasSubstr("up and down"),
                    Not(HasSubstr("of the middle one"))));
}

TEST(FrameCheck, ARealWrenchInTheWorldsFrameIsNamed) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(pose_file, "tool-gravity-axia80/recorded_messages_pose_100.txt");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(wrench_file, "tool-gravity-axia80/recorded_messages_wrench_100.txt");
  std::ifstream pose_in(pose_file), wrench_in(wrench_file);
  std::string pose_line, wrench_line;
  std::vector<StaticPose> poses;
  const auto numbers = [](std::string line) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream in(line);
    std::vector<double> values;
    for (double v = 0.0; in >> v;) values.push_back(v);
    return values;
  };
  while (std::getline(pose_in, pose_line) && std::getline(wrench_in, wrench_line)) {
    const auto p = numbers(pose_line), w = numbers(wrench_line);
    ASSERT_EQ(p.size(), 7U);
    ASSERT_EQ(w.size(), 6U);
    poses.push_back({Quat(p[6], p[3], p[4], p[5]).normalized(), {Vec3(w[0], w[1], w[2]), Vec3(w[3], w[4], w[5])}});
  }
  ASSERT_EQ(poses.size(), 100U);
  const auto as_read = recording::identify_tool(poses, standard_gravity, "axia80");
  const auto check = check_frames(poses, {}, as_read, standard_gravity, "axia80");
  ASSERT_TRUE(check.bad_fit);
  ASSERT_TRUE(check.repair);
  EXPECT_EQ(check.repair->flags(), "--wrench-frame world");
  // As the data's README has it from an independent fit: 1.24 kg, 0.29 N.
  EXPECT_NEAR(check.repaired.load.mass_kg, 1.24, 0.005);
  EXPECT_NEAR(check.repaired.fit.force_component_N, 0.29, 0.01);
}

}  // namespace
}  // namespace touchstone::acquisition
