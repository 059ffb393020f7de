// Renderers over a moving object, against exact answers: Galilean invariance, a wall that comes, a floor that carries.
#include "harness/rendering/moving_object.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/catalogue.h"
#include "renderers/hand_for_test.h"

namespace touchstone::renderers {
using rendering::MovingObject;
using rendering::StepResult;
using rendering::StepStatus;
using surface::TriangleMesh;

using namespace touchstone::testing;
namespace {

std::unique_ptr<rendering::Renderer> make(const std::string& json, const TriangleMesh& mesh) {
  return make_renderer(rendering::parse_model(R"({"schema": "touchstone-model/1", )" + json + "}", "test"),
                       make_embree_surface(mesh));
}

struct RigidMotion {
  Vec3 p_W_m = Vec3::Zero();
  Quat q_WB = Quat::Identity();
};

// Drifting, swinging and turning about two axes.
RigidMotion motion_at(double t_s, double scale) {
  const Vec3 p(0.3 * t_s * scale, 0.05 * std::sin(3.0 * t_s) * scale, -0.02 * t_s * t_s * scale);
  return {p, Quat(Eigen::AngleAxisd(0.7 * t_s, Vec3::UnitX())) *
                 Quat(Eigen::AngleAxisd(0.4 * std::sin(2.0 * t_s), Vec3::UnitZ()))};
}

class Everywhere : public ::testing::TestWithParam<std::string> {};

// Tip and object move together: what is felt is what is felt at rest, turned along.
TEST_P(Everywhere, MovingTogetherChangesNothing) {
  for (const double scale : {1e-2, 1.0, 1e2}) {
    const TriangleMesh mesh =
        moved(testing::torus(0.02, 0.008, 24, 12), awkward_rotation(), {0.01, 0.02, -0.03}, scale);
    const auto at_rest = make(GetParam(), mesh);
    MotionColumns poses;
    std::vector<rendering::TipState> tips;
    Random random(11);
    const auto surface = make_embree_surface(mesh);
    Vec3 p = surface->bounds().max() * 1.2;
    for (int i = 0; i < 1500; ++i) {
      const double t_s = 1e-3 * i;
      const surface::SurfacePoint foot = surface->closest(p);
      const double depth_m = 4e-4 * scale * std::sin(0.02 * i);
      p += 0.1 * (foot.p_W_m - depth_m * foot.n_W - p) + 1e-4 * scale * random.direction();
      tips.push_back({t_s, p, random.rotation()});
      const RigidMotion x = motion_at(t_s, scale);
      poses.t_s.push_back(t_s);
      poses.p_W_m.push_back(x.p_W_m);
      poses.q_WS.push_back(x.q_WB);
    }
    MovingObject moving(make(GetParam(), mesh), poses, "poses");
    at_rest->reset();
    moving.reset();
    double largest_N = 0.0;
    double worst_N = 0.0;
    double worst_m = 0.0;
    for (const rendering::TipState& tip : tips) {
      const RigidMotion x = motion_at(tip.t_s, scale);
      const StepResult expected = at_rest->step(tip);
      const StepResult obtained = moving.step({tip.t_s, x.p_W_m + x.q_WB * tip.p_W_m, x.q_WB * tip.q_WS});
      ASSERT_EQ(obtained.status, StepStatus::ok) << moving.failure();
      largest_N = std::max(largest_N, expected.f_W_N.norm());
      worst_N = std::max(worst_N, (obtained.f_W_N - x.q_WB * expected.f_W_N).norm());
      worst_m = std::max(worst_m, (obtained.contact_W_m - (x.p_W_m + x.q_WB * expected.contact_W_m)).norm());
    }
    ASSERT_GT(largest_N, 0.0);
    // The tip comes back from W rounded by some eps times how far off it is (0.5 scale); the force is k times that.
    const double rounding_m = 64.0 * 2.2e-16 * scale;
    EXPECT_LE(worst_N, 500.0 * rounding_m * 4.0) << scale;
    EXPECT_LE(worst_m, 4.0 * rounding_m) << scale;
  }
}

INSTANTIATE_TEST_SUITE_P(MovingObject, Everywhere,
                         ::testing::Values(R"("renderer": "god-object", "parameters": {"stiffness_N_per_m": 500})",
                                           R"("renderer": "spring-linear", "parameters": {"stiffness_N_per_m": 500})"),
                         [](const auto& tested) { return tested.index == 0 ? "god_object" : "spring_linear"; });

// A plate whose top is at z = v t rises to a tip that stays at z = 0, from 5 mm below: F = k v (t - t0).
TEST(MovingObject, AWallThatComesPushesByItsDepth) {
  const TriangleMesh plate = testing::grid(0.02, 4);
  constexpr double speed_m_per_s = 0.01;
  MotionColumns poses;
  for (const double t_s : {0.0, 1.0}) {  // two poses: between them the motion is uniform
    poses.t_s.push_back(t_s);
    poses.p_W_m.emplace_back(0.0, 0.0, -0.005 + speed_m_per_s * t_s);
    poses.q_WS.push_back(Quat::Identity());
  }
  MovingObject wall(make(R"("renderer": "god-object", "parameters": {"stiffness_N_per_m": 400})", plate), poses,
                    "poses");
  wall.reset();
  for (int i = 0; i <= 1000; ++i) {
    const double t_s = 1e-3 * i;
    const StepResult result = wall.step({t_s, Vec3(0.001, 0.002, 0.0), Quat::Identity()});
    ASSERT_EQ(result.status, StepStatus::ok);
    const double depth_m = std::max(0.0, -0.005 + speed_m_per_s * t_s);
    EXPECT_NEAR(result.f_W_N.z(), 400.0 * depth_m, 1e-12);
    if (depth_m > 1e-6) {
      EXPECT_NEAR((result.contact_W_m - Vec3(0.001, 0.002, depth_m)).norm(), 0.0, 1e-15);
    }
  }
}

// A floor slides below a resting tip that is pressed in by d: it is dragged along by mu k d, as a tip that slides the
// other way over a resting floor is held back.
TEST(MovingObject, AFloorThatSlidesDragsTheTipAlong) {
  const TriangleMesh floor = testing::grid(0.2, 4);
  constexpr double mu = 0.4;
  constexpr double probe_depth_m = 1e-3;
  constexpr double object_stiffness_N_per_m = 500.0;
  const std::string model =
      R"("renderer": "friction-cone", "parameters": {"stiffness_N_per_m": 500, "mu_static": 0.4, "mu_dynamic": 0.4})";
  MotionColumns poses;
  for (const double t_s : {0.0, 2.0}) {
    poses.t_s.push_back(t_s);
    poses.p_W_m.emplace_back(0.03 * t_s, -0.04 * t_s, 0.0);  // 50 mm/s
    poses.q_WS.push_back(Quat::Identity());
  }
  MovingObject moving(make(model, floor), poses, "poses");
  const auto resting = make(model, floor);
  moving.reset();
  resting->reset();
  for (int i = 0; i <= 1000; ++i) {
    const double t_s = 1e-3 * i;
    const double z_m = i < 50 ? 1e-3 - 4e-5 * i : -probe_depth_m;
    const StepResult dragged = moving.step({t_s, Vec3(0.0, 0.0, z_m), Quat::Identity()});
    const StepResult held = resting->step({t_s, Vec3(-0.03 * t_s, 0.04 * t_s, z_m), Quat::Identity()});
    EXPECT_NEAR((dragged.f_W_N - held.f_W_N).norm(), 0.0, 1e-12);
    if (t_s > 0.5) {
      EXPECT_NEAR((dragged.f_W_N - Vec3(0.6 * mu, -0.8 * mu, 1.0) * object_stiffness_N_per_m * probe_depth_m).norm(),
                  0.0, 1e-9);
    }
  }
}

TEST(MovingObject, ATurntableCarriesTheTipRound) {
  const TriangleMesh floor = testing::grid(0.2, 4);
  MotionColumns poses;
  for (int i = 0; i <= 10; ++i) {  // a tenth of a turn each: uniform between them
    poses.t_s.push_back(0.1 * i);
    poses.p_W_m.emplace_back(Vec3::Zero());
    poses.q_WS.emplace_back(Eigen::AngleAxisd(0.2 * std::numbers::pi * i, Vec3::UnitZ()));
  }
  const auto model =
      R"("renderer": "friction-cone", "parameters": {"stiffness_N_per_m": 500, "mu_static": 0.4, "mu_dynamic": 0.4})";
  MovingObject turning(make(model, floor), poses, "poses");
  turning.reset();
  StepResult result;
  for (int i = 0; i <= 900; ++i) {
    const double z_m = i < 50 ? 1e-3 - 4e-5 * i : -1e-3;
    result = turning.step({1e-3 * i, Vec3(0.05, 0.0, z_m), Quat::Identity()});
  }
  // At x = 50 mm the table moves along +y; the proxy lags inward by mu d (1 - cos): of second order in mu d / r.
  EXPECT_NEAR(result.f_W_N.y(), 0.4 * 0.5, 2e-4);
  EXPECT_NEAR(result.f_W_N.x(), 0.0, 4e-3);
  EXPECT_NEAR(result.f_W_N.z(), 0.5, 1e-12);
}

TEST(MovingObject, SaysWherePosesDoNotReach) {
  const TriangleMesh floor = testing::grid(0.2, 4);
  const auto model = R"("renderer": "god-object")";
  MotionColumns poses;
  poses.t_s = {0.0, 1.0};
  poses.p_W_m = {Vec3::Zero(), Vec3::Zero()};
  EXPECT_THROW(MovingObject(make(model, floor), poses, "poses.csv"), BadData);
  poses.q_WS = {Quat::Identity(), Quat::Identity()};
  MovingObject moving(make(model, floor), poses, "poses.csv");
  moving.reset();
  EXPECT_EQ(moving.step({0.5, Vec3::Zero(), Quat::Identity()}).status, StepStatus::ok);
  EXPECT_EQ(moving.step({1.5, Vec3::Zero(), Quat::Identity()}).status, StepStatus::failed);
  EXPECT_THAT(moving.failure(), ::testing::HasSubstr("poses.csv: the object's poses go from t_s = 0 to 1"));
  moving.reset();
  EXPECT_EQ(moving.step({0.5, Vec3::Zero(), Quat::Identity()}).status, StepStatus::ok);
  poses.t_s = {0.0};
  poses.p_W_m.resize(1);
  poses.q_WS.resize(1);
  EXPECT_THROW(MovingObject(make(model, floor), poses, "poses.csv"), BadData);
}

}  // namespace
}  // namespace touchstone::renderers
