#include "harness/tool/pose.h"

#include <gtest/gtest.h>

#include <numbers>

#include "harness/base/random.h"
#include "harness/tool/coupling.h"

namespace touchstone::tool {
namespace {

Pose random_pose(Random& random) { return {0.3 * random.direction(), random.rotation()}; }
Wrench random_wrench(Random& random) { return {5.0 * random.direction(), 0.4 * random.direction()}; }

// The homogeneous matrix, written out from the definition.
Eigen::Matrix4d matrix(const Pose& x) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = x.q_WT.toRotationMatrix();
  m.topRightCorner<3, 1>() = x.p_W_m;
  return m;
}

TEST(Pose, ComposesAndInvertsLikeMatrices) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    EXPECT_LE((matrix(a * b) - matrix(a) * matrix(b)).norm(), 1e-15 * 8);
    EXPECT_LE((matrix(a.inverse()) - matrix(a).inverse()).norm(), 1e-14);
  }
}

TEST(Pose, RotationOrderMatters) {
  // First a quarter turn about the tool's x, then one about the world's z: x stays on y, y goes to z.
  constexpr double quarter = 0.5 * std::numbers::pi;
  const Pose x{Vec3::Zero(), rotation_by(Vec3(quarter, 0, 0))};
  const Pose z{Vec3::Zero(), rotation_by(Vec3(0, 0, quarter))};
  EXPECT_LE(((z * x).to_W(Vec3::UnitX()) - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_LE(((z * x).to_W(Vec3::UnitY()) - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_LE(((x * z).to_W(Vec3::UnitX()) - Vec3::UnitZ()).norm(), 1e-15);
}

TEST(Pose, RotationVectorIsTheShortestAndUndoesItself) {
  Random random(12);
  for (const double angle : {0.0, 1e-12, 1e-6, 0.1, 1.0, 3.0, std::numbers::pi - 1e-9}) {
    const Vec3 v = angle * random.direction();
    const Quat q = rotation_by(v);
    EXPECT_LE((rotation_vector(q) - v).norm(), 4e-16 + 1e-15 * angle) << angle;
    EXPECT_LE((rotation_vector(Quat(-q.coeffs())) - v).norm(), 4e-16 + 1e-15 * angle) << "-q is the same rotation";
    EXPECT_LE((q.toRotationMatrix() -
               Eigen::AngleAxisd(angle, angle > 0.0 ? v.normalized() : Vec3::UnitX()).toRotationMatrix())
                  .norm(),
              1e-14);
  }
}

TEST(Pose, DisplacementTakesOnePoseToTheOther) {
  Random random(13);
  for (int i = 0; i < 100; ++i) {
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    EXPECT_LE((matrix(moved(a, displacement(a, b))) - matrix(b)).norm(), 1e-14);
  }
}

TEST(Wrench6, PowerIsTheSameInEveryFrame) {
  Random random(14);
  for (int i = 0; i < 200; ++i) {
    const Pose x = random_pose(random);
    const Wrench w = random_wrench(random);
    const Twist twist{random.direction(), 3.0 * random.direction()};
    EXPECT_NEAR(power_W(wrench_in(x, w), twist_in(x, twist)), power_W(w, twist), 1e-13);
  }
}

TEST(Wrench6, AdjointsComposeLikePoses) {
  Random random(15);
  for (int i = 0; i < 100; ++i) {
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    const Wrench w = random_wrench(random);
    const Wrench at_once = wrench_in(a * b, w);
    const Wrench in_turn = wrench_in(a, wrench_in(b, w));
    EXPECT_LE((at_once.f_N - in_turn.f_N).norm(), 1e-14);
    EXPECT_LE((at_once.torque_Nm - in_turn.torque_Nm).norm(), 1e-14);
  }
}

TEST(Wrench6, AtTheTipFromTheSensorIsTheSumOverTheContacts) {
  // The sensor's reading is made from contact forces by the definition of a torque alone.
  Random random(16);
  for (int i = 0; i < 100; ++i) {
    const Pose sensor = random_pose(random);
    const Vec3 tip = random.direction();
    Wrench at_sensor;
    Wrench at_tip;
    for (int c = 0; c < 3; ++c) {
      const Vec3 x = tip + 0.1 * random.direction();
      const Vec3 f = 3.0 * random.direction();
      at_sensor.f_N += f;
      at_sensor.torque_Nm += (x - sensor.p_W_m).cross(f);
      at_tip.f_N += f;
      at_tip.torque_Nm += (x - tip).cross(f);
    }
    const Mat3 r_SW = sensor.q_WT.toRotationMatrix().transpose();
    const Wrench reading{r_SW * at_sensor.f_N, r_SW * at_sensor.torque_Nm};
    const Wrench found = wrench_at_tip(reading, sensor, tip);
    EXPECT_LE((found.f_N - at_tip.f_N).norm(), 1e-14);
    EXPECT_LE((found.torque_Nm - at_tip.torque_Nm).norm(), 2e-14);
  }
}

TEST(Wrench6, OfTheObjectIsTheOpposite) {
  // Newton's third law in each body's own frame: the wrench on the object about its origin is minus that on the tool.
  Random random(17);
  for (int i = 0; i < 100; ++i) {
    const Pose tool = random_pose(random);
    const Vec3 x_W = random.direction();
    const Vec3 f_W = 2.0 * random.direction();
    const Wrench on_tool_T{tool.q_WT.conjugate() * f_W, tool.to_T(x_W).cross(tool.q_WT.conjugate() * f_W)};
    const Wrench on_object{-f_W, x_W.cross(-f_W)};
    const Wrench back = wrench_in(tool, on_tool_T);
    EXPECT_LE((back.f_N + on_object.f_N).norm(), 1e-14);
    EXPECT_LE((back.torque_Nm + on_object.torque_Nm).norm(), 1e-14);
  }
}

TEST(Coupling, WrenchIsTheGradientOfTheEnergy) {
  Random random(18);
  const Coupling coupling{800.0, 1.5};
  constexpr double step = 1e-5;
  for (int i = 0; i < 50; ++i) {
    const Pose handle = random_pose(random);
    const Pose proxy = moved(handle, {2e-3 * random.direction(), 0.8 * random.direction()});
    const Wrench w = coupling_wrench(coupling, handle, proxy);
    for (int k = 0; k < 3; ++k) {
      const Vec3 e = step * Vec3::Unit(k);
      const auto slope = [&](const Displacement& d, const Displacement& minus) {
        return (coupling_energy_J(coupling, handle, moved(proxy, d)) -
                coupling_energy_J(coupling, handle, moved(proxy, minus))) /
               (2 * step);
      };
      EXPECT_NEAR(slope({e, Vec3::Zero()}, {-e, Vec3::Zero()}), w.f_N[k], 1e-9);
      EXPECT_NEAR(slope({Vec3::Zero(), e}, {Vec3::Zero(), -e}), w.torque_Nm[k], 1e-8);
    }
  }
}

}  // namespace
}  // namespace touchstone::tool
