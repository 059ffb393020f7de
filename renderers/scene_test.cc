// Renderers over several bodies that move against each other, against exact answers: everything moving together changes
// nothing, a wall that comes pushes by its depth, a floor that slides carries by friction, corners of two bodies.
#include "harness/rendering/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/rendering/moving_object.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/allocation_guard.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/catalogue.h"
#include "renderers/hand_for_test.h"

namespace touchstone::renderers {
using rendering::BodyPose;
using rendering::BodyScene;
using rendering::Model;
using rendering::PoseTrack;
using rendering::Renderer;
using rendering::StepResult;
using rendering::StepStatus;
using surface::TriangleMesh;

using namespace touchstone::testing;
namespace {

constexpr double tick_s = 1e-3;
constexpr double stiffness = 500.0;

BodyPose at_rest(const Vec3& p = Vec3::Zero(), const Quat& q = Quat::Identity()) { return {p, q}; }
// a after b: x -> a(b(x)).
BodyPose after(const BodyPose& a, const BodyPose& b) { return {a.to_W(b.p_W_m), a.q_WB * b.q_WB}; }

// A pose per tick, so that at each sample it is the function's own.
PoseTrack track(const std::function<BodyPose(double)>& pose, int ticks) {
  MotionColumns poses;
  for (int i = 0; i <= ticks; ++i) {
    const BodyPose now = pose(tick_s * i);
    poses.t_s.push_back(tick_s * i);
    poses.p_W_m.push_back(now.p_W_m);
    poses.q_WS.push_back(now.q_WB);
  }
  return {poses, "poses"};
}

struct Moving {
  TriangleMesh mesh;
  std::function<BodyPose(double)> pose;
};

std::shared_ptr<const BodyScene> scene_of(const std::vector<Moving>& bodies, int ticks) {
  auto scene = std::make_shared<BodyScene>();
  scene->source = "test scene";
  for (const Moving& body : bodies) {
    scene->bodies.push_back(
        {"body " + std::to_string(scene->bodies.size()), make_embree_surface(body.mesh), track(body.pose, ticks)});
  }
  return scene;
}

Model model(const std::string& renderer, double mu = 0.0) {
  std::map<std::string, double> parameters{{"stiffness_N_per_m", stiffness}};
  if (mu > 0.0) {
    parameters["mu_static"] = mu;
    parameters["mu_dynamic"] = mu;
  }
  return model_of(renderer, parameters);
}

TriangleMesh box(const Vec3& low, const Vec3& high) {
  TriangleMesh mesh = testing::cube(1.0);
  for (Vec3& v : mesh.vertices_W_m) {
    for (Eigen::Index i = 0; i < 3; ++i) v[i] = v[i] < 0.0 ? low[i] : high[i];
  }
  return mesh;
}
TriangleMesh floor_box() { return box({-0.05, -0.05, -0.02}, {0.05, 0.05, 0.0}); }

// Drifting, swinging and turning about two axes.
BodyPose swing(double t_s, double scale) {
  return {Vec3(0.3 * t_s, 0.05 * std::sin(3.0 * t_s), -0.02 * t_s * t_s) * scale,
          Quat(Eigen::AngleAxisd(0.7 * t_s, Vec3::UnitX())) *
              Quat(Eigen::AngleAxisd(0.4 * std::sin(2.0 * t_s), Vec3::UnitZ()))};
}

// A hand that goes about the first body's surface, in and out of it, at a tick each.
std::vector<Vec3> stroll(const TriangleMesh& over, double scale, std::uint64_t seed, int ticks) {
  Random random(seed);
  const auto surface = make_embree_surface(over);
  Vec3 p = surface->bounds().max() * 1.2;
  std::vector<Vec3> path;
  for (int i = 0; i <= ticks; ++i) {
    const surface::SurfacePoint foot = surface->closest(p);
    const double depth_m = 4e-4 * scale * std::sin(0.02 * i);
    p += 0.1 * (foot.p_W_m - depth_m * foot.n_W - p) + 1e-4 * scale * random.direction();
    path.push_back(p);
  }
  return path;
}

struct Differences {
  double largest_N = 0.0;
  double force_N = 0.0;
  double place_m = 0.0;
  int touched = 0;
};

// The same tips over both, the second seen from a frame that moves: how far its answers, turned back, are off.
Differences compare(Renderer& first, Renderer& second, const std::vector<Vec3>& tips,
                    const std::function<BodyPose(double)>& frame) {
  first.reset();
  second.reset();
  Differences out;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const double t_s = tick_s * static_cast<double>(i);
    const BodyPose x = frame(t_s);
    const StepResult expected = first.step({t_s, tips[i], Quat::Identity()});
    const StepResult obtained = second.step({t_s, x.to_W(tips[i]), x.q_WB});
    EXPECT_EQ(expected.status, StepStatus::ok) << first.failure();
    EXPECT_EQ(obtained.status, StepStatus::ok) << second.failure();
    if (obtained.status != StepStatus::ok) break;
    out.touched += expected.contact ? 1 : 0;
    out.largest_N = std::max(out.largest_N, expected.f_W_N.norm());
    const double off_N = (obtained.f_W_N - x.q_WB * expected.f_W_N).norm();
    out.force_N = std::max(out.force_N, off_N);
    out.place_m = std::max(out.place_m, (obtained.contact_W_m - x.to_W(expected.contact_W_m)).norm());
  }
  return out;
}

class SceneOf : public ::testing::TestWithParam<std::pair<const char*, double>> {
 protected:
  [[nodiscard]] Model tested() const { return model(GetParam().first, GetParam().second); }
  [[nodiscard]] std::unique_ptr<Renderer> over(const std::vector<Moving>& bodies, int ticks) const {
    return make_scene_renderer(tested(), scene_of(bodies, ticks));
  }
};

INSTANTIATE_TEST_SUITE_P(Scenes, SceneOf,
                         ::testing::Values(std::pair("god-object", 0.0), std::pair("friction-cone", 0.0),
                                           std::pair("friction-cone", 0.4), std::pair("force-shading", 0.0),
                                           std::pair("force-shading", 0.4)),
                         [](const auto& tested) {
                           std::string name = tested.param.first;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name + (tested.param.second > 0.0 ? "_with_friction" : "");
                         });

// Two bodies, one overlapping the other, that move together answer as they do at rest; without friction that is the
// answer of one object of their joined mesh. (With friction a mesh walks where a scene goes by planes, near the joint.)
TEST_P(SceneOf, BodiesThatMoveTogetherAreOneObjectThatMoves) {
  constexpr int tick_count = 1500;
  for (const double scale : {1e-2, 1.0, 1e2}) {
    const TriangleMesh first = moved(testing::torus(0.02, 0.008, 24, 12), awkward_rotation(), {0.0, 0.0, 0.0}, scale);
    const TriangleMesh second = moved(testing::cube(0.006), awkward_rotation(), Vec3(0.024, 0.01, 0.0) * scale, scale);
    const auto frame = [&](double t_s) { return swing(t_s, scale); };
    const auto tips = stroll(first, scale, 11, tick_count);
    BodyScene joined;
    for (const TriangleMesh& mesh : {first, second})
      joined.bodies.push_back({"", make_embree_surface(mesh), PoseTrack()});
    const auto rest = [](double) { return at_rest(); };
    const auto still = GetParam().second > 0.0 ? over({{first, rest}, {second, rest}}, tick_count)
                                               : make_renderer(tested(), make_embree_surface(joined_mesh(joined)));
    const auto together = over({{first, frame}, {second, frame}}, tick_count);
    const Differences off = compare(*still, *together, tips, frame);
    ASSERT_GT(off.touched, 300);
    // The tip comes back from W rounded by some eps times how far off it is (0.5 scale); the force is k times that.
    const double rounding_m = 256.0 * 2.2e-16 * scale;
    EXPECT_LE(off.place_m, 4.0 * rounding_m) << scale;
    EXPECT_LE(off.force_N, 4.0 * stiffness * rounding_m) << scale;
  }
}

// The whole of a scene in which bodies move against each other, seen from a frame that moves.
TEST_P(SceneOf, SeenFromAMovingFrameItIsTheSame) {
  constexpr int tick_count = 2000;
  const TriangleMesh ground = floor_box();
  const TriangleMesh ram = moved(testing::torus(0.02, 0.008, 24, 12), awkward_rotation(), Vec3::Zero());
  const TriangleMesh slab = box({-0.01, -0.04, -0.01}, {0.01, 0.04, 0.03});
  const auto ram_pose = [](double t_s) {
    return BodyPose{{0.02 * std::sin(3.0 * t_s), 0.01 * std::cos(2.0 * t_s), 0.004},
                    Quat(Eigen::AngleAxisd(0.5 * t_s, Vec3::UnitZ()))};
  };
  const auto slab_pose = [](double t_s) {
    return BodyPose{{0.045 - 0.02 * t_s, 0.0, 0.0}, Quat(Eigen::AngleAxisd(0.2 * t_s, Vec3::UnitY()))};
  };
  Random random(5);
  std::vector<Vec3> tips;
  Vec3 p(-0.03, -0.03, 0.02);
  for (int i = 0; i <= tick_count; ++i) {
    const double t_s = tick_s * i;
    const Vec3 aim(0.035 * std::sin(1.7 * t_s + 1.0), 0.03 * std::sin(2.3 * t_s), 0.004 * std::cos(5.0 * t_s));
    p += 0.05 * (aim - p) + 2e-5 * random.direction();
    tips.push_back(p);
  }
  const auto frame = [](double t_s) { return swing(t_s, 1.0); };
  const auto seen = [&](auto pose) { return [=](double t_s) { return after(frame(t_s), pose(t_s)); }; };
  const auto rest = [](double) { return at_rest(); };
  const auto one = over({{ground, rest}, {ram, ram_pose}, {slab, slab_pose}}, tick_count);
  const auto other = over({{ground, seen(rest)}, {ram, seen(ram_pose)}, {slab, seen(slab_pose)}}, tick_count);
  const Differences off = compare(*one, *other, tips, frame);
  ASSERT_GT(off.touched, 500);
  // Rounding, and where contacts begin what counts as flush (12 nm here).
  EXPECT_LE(off.force_N, stiffness * 0x1p-22 * 0.06 * 8.0);
}

// One body of a scene that moves, the other far away, is that body alone.
TEST_P(SceneOf, AFarBodyChangesNothing) {
  constexpr int tick_count = 1500;
  const TriangleMesh mesh = moved(testing::torus(0.02, 0.008, 24, 12), awkward_rotation(), Vec3::Zero());
  const auto pose = [](double t_s) { return swing(t_s, 0.2); };
  const auto tips_B = stroll(mesh, 1.0, 3, tick_count);
  std::vector<Vec3> tips;
  for (std::size_t i = 0; i < tips_B.size(); ++i) tips.push_back(pose(tick_s * static_cast<double>(i)).to_W(tips_B[i]));
  rendering::MovingObject alone(make_renderer(tested(), make_embree_surface(mesh)), track(pose, tick_count));
  const auto scene = over({{mesh, pose},
                           {testing::cube(0.01),
                            [](double t_s) {
                              return at_rest({1.0 + t_s, 0, 0});
                            }}},
                          tick_count);
  const Differences off = compare(alone, *scene, tips, [](double) { return at_rest(); });
  ASSERT_GT(off.touched, 300);
  EXPECT_LE(off.force_N, 1e-10);
}

TEST_P(SceneOf, AllocatesNothingInAStep) {
  const auto slab_pose = [](double t_s) { return at_rest({0.02 - 0.03 * t_s, 0.0, 0.0}); };
  const auto renderer = over(
      {{floor_box(), [](double) { return at_rest(); }}, {box({-0.01, -0.04, -0.01}, {0.01, 0.04, 0.03}), slab_pose}},
      1000);
  renderer->reset();
  const testing::AllocationGuard guard;
  for (int i = 0; i <= 1000; ++i) {
    const StepResult result = renderer->step({tick_s * i, {0.0, 0.001, 0.001 - 2e-6 * i}, Quat::Identity()});
    ASSERT_EQ(result.status, StepStatus::ok);
  }
  EXPECT_EQ(guard.count(), 0U);
}

// A wall comes along -x to a tip that is pressed d into a floor at rest: without friction F = k (depth in the wall, 0,
// d), from the moment when it arrives.
TEST(Scene, AWallThatComesPushesByItsDepthWhileTheFloorHolds) {
  constexpr double press_depth = 1e-3;
  for (const double speed : {0.005, 0.05, 0.5}) {
    const auto wall = [=](double t_s) {
      return at_rest({0.025 - speed * t_s, 0.0, 0.0});
    };  // its face at x = -0.01 of B
    const int ticks = static_cast<int>(0.018 / speed / tick_s);
    const auto scene = scene_of(
        {{floor_box(), [](double) { return at_rest(); }}, {box({-0.01, -0.04, -0.01}, {0.01, 0.04, 0.03}), wall}},
        ticks);
    const auto renderer = make_scene_renderer(model("god-object"), scene);
    renderer->reset();
    for (int i = 0; i <= ticks; ++i) {
      const Vec3 tip(0.0, 0.002, i < 5 ? 1e-3 - 5e-4 * i : -press_depth);
      const StepResult result = renderer->step({tick_s * i, tip, Quat::Identity()});
      if (i < 5) continue;
      const double depth_m = std::max(0.0, -(0.015 - speed * tick_s * i));
      ASSERT_NEAR(result.f_W_N.z(), stiffness * press_depth, 1e-9) << speed << " " << i;
      ASSERT_NEAR(result.f_W_N.x(), -stiffness * depth_m, 1e-9) << speed << " " << i;
      ASSERT_NEAR(result.f_W_N.y(), 0.0, 1e-12);
    }
  }
}

// Two blocks close to a wedge: the god-object is the point nearest to the tip in front of both faces.
TEST(Scene, AWedgeThatClosesIsTheNearestPointInFrontOfBoth) {
  constexpr int tick_count = 1000;
  const double lean = 0.5;
  const auto block = box({-0.04, -0.04, -0.03}, {0.04, 0.04, 0.0});  // its face is z = 0 of B
  const auto left = [=](double) { return at_rest({0, 0, 0}, Quat(Eigen::AngleAxisd(lean, Vec3::UnitY()))); };
  const auto right = [=](double t_s) {
    return at_rest({0.0, 0.0, 0.01 * t_s - 0.004}, Quat(Eigen::AngleAxisd(-lean, Vec3::UnitY())));
  };
  const auto renderer = make_scene_renderer(model("god-object"), scene_of({{block, left}, {block, right}}, tick_count));
  renderer->reset();
  for (int i = 0; i <= tick_count; ++i) {
    const double t_s = tick_s * i;
    const double down = std::min(1.0, i / 50.0);
    const Vec3 tip(0.001, 0.0, 0.01 - 0.0125 * down);
    const StepResult result = renderer->step({t_s, tip, Quat::Identity()});
    if (i < 100) continue;
    // Faces n_i . x >= b_i; the answer from the normal equations, by hand.
    const Vec3 n1 = left(t_s).q_WB * Vec3::UnitZ();
    const Vec3 n2 = right(t_s).q_WB * Vec3::UnitZ();
    const double b1 = n1.dot(left(t_s).p_W_m) - n1.dot(tip);
    const double b2 = n2.dot(right(t_s).p_W_m) - n2.dot(tip);
    const double c = n1.dot(n2);
    double l1 = (b1 - c * b2) / (1.0 - c * c);
    double l2 = (b2 - c * b1) / (1.0 - c * c);
    if (l1 < 0.0) {
      l1 = 0.0;
      l2 = std::max(0.0, b2);
    } else if (l2 < 0.0) {
      l2 = 0.0;
      l1 = std::max(0.0, b1);
    }
    ASSERT_NEAR((result.f_W_N - stiffness * (l1 * n1 + l2 * n2)).norm(), 0.0, 1e-9) << i;
  }
}

// A thin plate that comes fast takes the god-object along on its front side, however far it moves in a step.
TEST(Scene, AThinPlateThatComesFastPassesOverNothing) {
  const auto plate = box({-0.0005, -0.04, -0.04}, {0.0005, 0.04, 0.04});
  for (const double step_m : {1e-4, 7e-4, 3e-3, 9e-3}) {
    const auto pose = [=](double t_s) { return at_rest({-0.012 + step_m * t_s / tick_s, 0.0, 0.0}); };
    const auto scene = scene_of({{plate, pose},
                                 {floor_box(),
                                  [](double) {
                                    return at_rest({0, 0, -0.2});
                                  }}},
                                static_cast<int>(0.03 / step_m));
    const auto renderer = make_scene_renderer(model("god-object"), scene);
    renderer->reset();
    for (int i = 0; i <= static_cast<int>(0.03 / step_m); ++i) {
      const StepResult result = renderer->step({tick_s * i, {0.0, 0.001, 0.002}, Quat::Identity()});
      const double depth_m = -0.012 + step_m * i + 0.0005;
      if (std::abs(depth_m) > 1e-12) {
        ASSERT_NEAR(result.f_W_N.x(), depth_m > 0.0 ? stiffness * depth_m : 0.0, 1e-9) << step_m << " " << i;
      }
    }
  }
}

// A belt slides below a tip that presses on it, between two guides that stand off the belt and do not touch the tip: it
// is dragged by mu k d as on the belt alone.
TEST(Scene, ABeltDragsTheTipByFrictionBetweenGuides) {
  constexpr double true_mu = 0.4;
  constexpr double press_depth = 1e-3;
  const auto belt_pose = [](double t_s) { return at_rest({0.03 * t_s, -0.04 * t_s, 0.0}); };
  const auto guide = box({-0.04, 0.002, 0.0005}, {0.04, 0.01, 0.02});
  const auto scene = scene_of({{box({-0.3, -0.3, -0.02}, {0.3, 0.3, 0.0}), belt_pose},
                               {guide, [](double) { return at_rest(); }},
                               {guide,
                                [](double) {
                                  return at_rest({0.0, -0.014, 0.0});
                                }}},
                              1000);
  const auto renderer = make_scene_renderer(model("friction-cone", true_mu), scene);
  renderer->reset();
  for (int i = 0; i <= 1000; ++i) {
    const double z_m = i < 50 ? 1e-3 - 4e-5 * i : -press_depth;
    const StepResult result = renderer->step({tick_s * i, {0.0, 0.0, z_m}, Quat::Identity()});
    if (i < 500) continue;
    ASSERT_NEAR((result.f_W_N - Vec3(0.6 * true_mu, -0.8 * true_mu, 1.0) * stiffness * press_depth).norm(), 0.0, 1e-8)
        << i;
  }
}

// The belt drags the tip's proxy against a stop at rest. Before it arrives friction is on the cone; then the stop holds
// it: the belt slides below, and the tip, at the stop's face, feels the belt's pull no more than the cone allows.
TEST(Scene, ABeltDragsTheProxyAgainstAStop) {
  constexpr double true_mu = 0.5;
  constexpr double press_depth = 2e-3;
  const auto belt_pose = [](double t_s) { return at_rest({0.02 * t_s, 0.0, 0.0}); };
  const auto stop = box({0.0004, -0.04, -0.01}, {0.01, 0.04, 0.02});
  const auto scene = scene_of(
      {{box({-0.3, -0.3, -0.02}, {0.3, 0.3, 0.0}), belt_pose}, {stop, [](double) { return at_rest(); }}}, 1000);
  const auto renderer = make_scene_renderer(model("friction-cone", true_mu), scene);
  renderer->reset();
  for (int i = 0; i <= 1000; ++i) {
    const double z_m = i < 50 ? 1e-3 - 6e-5 * i : -press_depth;
    const StepResult result = renderer->step({tick_s * i, {0.0, 0.0, z_m}, Quat::Identity()});
    ASSERT_LE(result.f_W_N.head<2>().norm(), true_mu * stiffness * press_depth + 1e-6);
    // The proxy never enters the stop: 0.4 mm is below mu d = 1 mm.
    ASSERT_LE(result.contact_W_m.x(), 0.0004 + 1e-9) << i;
    if (i < 500) continue;
    ASSERT_NEAR(result.f_W_N.z(), stiffness * press_depth, 1e-6);
    ASSERT_GE(result.f_W_N.x(), -1e-9) << i;
  }
}

TEST(Scene, AnythingRendersBodiesAtRest) {
  auto scene = std::make_shared<BodyScene>();
  scene->source = "test scene";
  scene->bodies.push_back({"low", make_embree_surface(floor_box()), PoseTrack()});
  scene->bodies.push_back({"high", make_embree_surface(testing::cube(0.01)), PoseTrack(at_rest({0.03, 0.0, 0.005}))});
  for (const char* const name : {"god-object", "penalty", "spring-linear"}) {
    const auto renderer = make_scene_renderer(model_of(name, {{"stiffness_N_per_m", stiffness}}), scene);
    Hand hand(*renderer);
    hand.stroke({-0.02, 0.0, 0.01}, {-0.02, 0.0, -0.001}, 20);
    EXPECT_NEAR(hand.to({-0.02, 0.0, -0.001}).f_W_N.z(), 0.5, 1e-9) << name;
    hand.stroke({0.03, 0.0, 0.03}, {0.03, 0.0, 0.014}, 20);
    EXPECT_NEAR(hand.to({0.03, 0.0, 0.014}).f_W_N.z(), 0.5, 1e-9) << name;
  }
}

TEST(Scene, OneBodyInAPoseIsAnyRenderersToo) {
  auto scene = std::make_shared<BodyScene>();
  scene->source = "test scene";
  scene->bodies.push_back({"leaning", make_embree_surface(testing::grid(0.05, 4)),
                           PoseTrack(at_rest({0.0, 0.0, 0.1}, Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX()))))});
  const auto renderer = make_scene_renderer(model_of("spring-linear", {{"stiffness_N_per_m", stiffness}}), scene);
  Hand hand(*renderer);
  const Vec3 n = scene->bodies[0].pose.first().q_WB * Vec3::UnitZ();
  hand.to(Vec3(0.0, 0.0, 0.1) + 0.002 * n);
  EXPECT_NEAR((hand.to(Vec3(0.0, 0.0, 0.1) - 0.001 * n).f_W_N - 0.5 * n).norm(), 0.0, 1e-12);
}

std::string refusal(const Model& wanted, const std::shared_ptr<const BodyScene>& scene) {
  try {
    make_scene_renderer(wanted, scene);
  } catch (const BadData& error) {
    return error.what();
  }
  return "none";
}

TEST(Scene, SaysWhatItCannot) {
  const auto still = [](double) { return at_rest(); };
  const auto scene = scene_of({{floor_box(), still}, {testing::cube(0.01), still}}, 10);
  using ::testing::AllOf;
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal(model_of("penalty", {}), scene), AllOf(HasSubstr("renderer penalty takes one object"),
                                                             HasSubstr("god-object, friction-cone, force-shading")));
  EXPECT_THAT(refusal(model_of("god-object", {{"tip_radius_m", 0.001}}), scene), HasSubstr("tip_radius_m = 0.001"));
  Model with_effect = model("god-object");
  with_effect.effects.push_back({"coulomb-friction", {{"mu_static", 0.3}, {"mu_dynamic", 0.3}}, "/effects/0"});
  EXPECT_THAT(refusal(with_effect, scene), HasSubstr("/effects: coulomb-friction acts on the contact with one object"));
  EXPECT_THAT(refusal(model_of("god-object", {{"stiffness", 1.0}}), scene), HasSubstr("stiffness"));
}

TEST(Scene, SaysWherePosesDoNotReach) {
  const auto still = [](double) { return at_rest(); };
  const auto renderer =
      make_scene_renderer(model("god-object"), scene_of({{floor_box(), still}, {testing::cube(0.01), still}}, 10));
  renderer->reset();
  EXPECT_EQ(renderer->step({0.005, {0, 0, 0.02}, Quat::Identity()}).status, StepStatus::ok);
  EXPECT_EQ(renderer->step({0.5, {0, 0, 0.02}, Quat::Identity()}).status, StepStatus::failed);
  EXPECT_THAT(renderer->failure(), ::testing::HasSubstr("poses: the object's poses go from t_s = 0 to 0.01; the "
                                                        "trajectory has t_s = 0.5"));
  renderer->reset();
  EXPECT_EQ(renderer->step({0.005, {0, 0, 0.02}, Quat::Identity()}).status, StepStatus::ok);
}

// A run that begins inside starts at the closest place that is reached from outside, of all bodies.
TEST(Scene, StartsInsideAtTheClosestPlaceOutside) {
  const auto still = [](double) { return at_rest(); };
  const auto renderer = make_scene_renderer(model("god-object"), scene_of({{floor_box(), still},
                                                                           {testing::cube(0.01),
                                                                            [](double) {
                                                                              return at_rest({0, 0, -0.008});
                                                                            }}},
                                                                          10));
  renderer->reset();
  // 2 mm above the floor's top, 0.5 mm in the cube that stands out of the floor.
  const StepResult result = renderer->step({0.0, {0.0095, 0.0, 0.001}, Quat::Identity()});
  EXPECT_NEAR((result.f_W_N - Vec3(0.25, 0, 0)).norm(), 0.0, 1e-9);
}

// A press that comes down into the floor, over a tip that is pressed into it, leaves no space: the god-object stays on
// the floor, whose force is F = k dx as before and after.
TEST(Scene, APressThatLeavesNoSpaceDoesNotTakeTheFloorAway) {
  constexpr double press_depth = 1e-3;
  const auto press = [](double t_s) {  // down to -0.2 mm, twice
    return at_rest({0, 0, 0.0004 + 0.0006 * std::cos(4.0 * std::numbers::pi * t_s)});
  };
  for (const double mu : {0.0, 0.4}) {
    const auto renderer = make_scene_renderer(model(mu > 0.0 ? "friction-cone" : "god-object", mu),
                                              scene_of({{floor_box(), [](double) { return at_rest(); }},
                                                        {box({-0.02, -0.02, 0.0}, {0.02, 0.02, 0.02}), press}},
                                                       1000));
    renderer->reset();
    for (int i = 0; i <= 1000; ++i) {
      const Vec3 tip(0.001, 0.002, i < 5 ? 5e-4 - 3e-4 * i : -press_depth);
      const StepResult result = renderer->step({tick_s * i, tip, Quat::Identity()});
      if (i >= 5) {
        ASSERT_NEAR(result.f_W_N.z(), stiffness * press_depth, 1e-9) << mu << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::renderers
