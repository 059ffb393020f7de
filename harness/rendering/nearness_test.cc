#include "harness/rendering/nearness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::rendering {
namespace {

using ::testing::HasSubstr;

// A 30 mm body away from the origin, and a path that touches a part of it.
surface::TriangleMesh body(double scale) {
  return surface::moved(testing::ball(0.03, 4), Quat::Identity(), Vec3(0.1, 0.02, -0.05) * scale, scale);
}

std::vector<Vec3> path(double off_m) {
  Random random(4);
  std::vector<Vec3> tips;
  for (int i = 0; i < 5000; ++i) {
    tips.emplace_back(Vec3(0.1, 0.02, -0.05) +
                      (0.03 + off_m) * (Vec3::UnitZ() + 0.3 * random.direction()).normalized());
  }
  return tips;
}

TEST(Nearness, FittingPairsPass) {
  const auto surface = make_embree_surface(body(1.0));
  for (const double off : {0.0, 0.0005, -0.004})
    EXPECT_EQ(far_from_surface(*surface, path(off), {}, 0.0, "r.csv", "m"), std::nullopt) << off;
  EXPECT_EQ(far_from_surface(*surface, path(0.00315), {}, 0.00315, "r.csv", "m"), std::nullopt);
  EXPECT_EQ(far_from_surface(*surface, {}, {}, 0.0, "r.csv", "m"), std::nullopt);
}

TEST(Nearness, AsksForTheUnitThatFits) {
  struct Case {
    double scale;
    const char* assumed;
    const char* message;
  };
  for (const Case& c : {Case{1e3, "m", "Is the mesh in mm? With --mesh-unit mm (now m: a factor of 0.001)"},
                        Case{1e2, "m", "Is the mesh in cm?"},
                        Case{1e-3, "mm", "Is the mesh in m? With --mesh-unit m (now mm: a factor of 1000)"},
                        Case{1e-3, "m", "Is the mesh in km?"}}) {
    const auto surface = make_embree_surface(body(c.scale));
    const auto message = far_from_surface(*surface, path(0.0), {}, 0.0, "r.csv", c.assumed);
    ASSERT_TRUE(message) << c.scale;
    EXPECT_THAT(*message, HasSubstr(c.message));
    EXPECT_THAT(*message, HasSubstr("r.csv is nowhere near ball"));
  }
}

// Read in m where it is in mm, the body is 1000 times as large and the path lies deep within it; read in mm where it is
// in m, the body is small and far. In the mesh's own unit the path may lie anywhere.
TEST(Nearness, PathsThatTouchInAnotherUnitAloneAreRefused) {
  const surface::TriangleMesh at_origin = testing::ball(0.03, 4);
  std::vector<Vec3> tips = path(0.0);
  for (Vec3& tip : tips) tip -= Vec3(0.1, 0.02, -0.05);
  for (const auto& [scale, assumed, unit] : {std::tuple{1e3, "m", "--mesh-unit mm"},
                                             {1e2, "m", "--mesh-unit cm"},
                                             {1.0 / 0.0254, "m", "--mesh-unit in"},
                                             {1e-3, "mm", "--mesh-unit m "},
                                             {1e-2, "cm", "--mesh-unit m "}}) {
    const auto surface = make_embree_surface(surface::moved(at_origin, Quat::Identity(), Vec3::Zero(), scale));
    const auto message = fits_another_unit(*surface, tips, 0.0, "r.csv", assumed);
    ASSERT_TRUE(message) << scale;
    EXPECT_THAT(*message, HasSubstr(unit));
  }
  const auto fitting = make_embree_surface(at_origin);
  EXPECT_EQ(fits_another_unit(*fitting, tips, 0.0, "r.csv", "m"), std::nullopt);
  const std::vector<Vec3> within(5, Vec3(0.001, 0, 0));
  EXPECT_EQ(fits_another_unit(*fitting, within, 0.0, "r.csv", "m"), std::nullopt);
  for (const double away : {0.05, 0.5, 50.0}) {
    std::vector<Vec3> outside = tips;
    for (Vec3& tip : outside) tip += Vec3(0, 0, away);
    EXPECT_EQ(fits_another_unit(*fitting, outside, 0.0, "r.csv", "m"), std::nullopt) << "outside it may be anywhere";
  }
}

// A tool that is turned in the air above the object moves its tip by a tracker's noise.
TEST(Nearness, AToolThatIsHeldInTheAirIsNoFault) {
  const auto surface = make_embree_surface(body(1.0));
  Random random(5);
  std::vector<Vec3> tips;
  for (int i = 0; i < 500; ++i) tips.emplace_back(Vec3(0.1, 0.02, 0.0) + 1e-4 * random.direction());
  EXPECT_EQ(far_from_surface(*surface, tips, {}, 0.0, "r.csv", "m"), std::nullopt);
  EXPECT_TRUE(held_in_the_air(*surface, tips, 0.0));
  EXPECT_FALSE(held_in_the_air(*surface, path(0.0), 0.0));
  for (Vec3& tip : tips) tip.z() += 0.5;
  EXPECT_TRUE(far_from_surface(*surface, tips, {}, 0.0, "r.csv", "m")) << "farther than the object is large";
}

// Pressed by a spring into a soft ball whose top is at the origin: scaled about it the surface stays near and only its
// curvature tells.
struct Press {
  std::vector<Vec3> tips;
  std::vector<double> loads_N;
};

Press press_into_ball_below_origin(double softness_m_per_N) {
  Press press;
  Random random(6);
  for (int i = 0; i < 800; ++i) {
    const Vec3 outward = (Vec3::UnitZ() + 0.5 * random.direction()).normalized();
    press.loads_N.push_back(0.1 + 0.01 * (i % 200));
    press.tips.emplace_back(Vec3(0, 0, -0.03) + (0.03 - softness_m_per_N * press.loads_N.back()) * outward);
  }
  return press;
}

TEST(Nearness, ContactThatOnlyAnotherUnitExplainsIsRefused) {
  const surface::TriangleMesh below = surface::moved(testing::ball(0.03, 5), Quat::Identity(), Vec3(0, 0, -0.03), 1.0);
  // Softer than a finger, and hard.
  for (const double softness : {2e-3, 2e-5}) {
    const Press press = press_into_ball_below_origin(softness);
    EXPECT_EQ(far_from_surface(*make_embree_surface(below), press.tips, press.loads_N, 0.0, "r.csv", "m"),
              std::nullopt);
    for (const auto& [scale, assumed, unit] : {std::tuple{1000.0, "m", "--mesh-unit mm"},
                                               {1.0 / 0.0254, "m", "--mesh-unit in"},
                                               {0.3048, "ft", "--mesh-unit m"},
                                               {0.001, "mm", "--mesh-unit m"},
                                               {10.0, "cm", "--mesh-unit mm"}}) {
      const auto wrong = make_embree_surface(surface::moved(below, Quat::Identity(), Vec3::Zero(), scale));
      const auto message = far_from_surface(*wrong, press.tips, press.loads_N, 0.0, "r.csv", assumed);
      ASSERT_TRUE(message) << scale << " at " << softness << " m/N";
      EXPECT_THAT(*message, HasSubstr(unit));
    }
  }
}

// A floor passes in every unit in which it is where it is touched: no number depends on its size.
TEST(Nearness, AFloorIsRefusedOnlyWhereItDoesNotReach) {
  const auto floor = [](double half_side_m) {
    const double a = half_side_m;
    return make_embree_surface(
        surface::TriangleMesh{.vertices_W_m = {Vec3(-a, -a, 0), Vec3(a, -a, 0), Vec3(a, a, 0), Vec3(-a, a, 0)},
                              .triangles = {{0, 1, 2}, {0, 2, 3}},
                              .source = "floor",
                              .notes = {}});
  };
  Press press;
  for (int i = 0; i < 500; ++i) {
    press.loads_N.push_back(1.0 + std::sin(0.1 * i));
    press.tips.emplace_back(0.3 + 0.0001 * i, 0.4 - 0.00005 * i, -0.001 * press.loads_N.back());
  }
  for (const double half_side_m : {1.0, 10.0, 1000.0}) {
    EXPECT_EQ(far_from_surface(*floor(half_side_m), press.tips, press.loads_N, 0.0, "r.csv", "m"), std::nullopt);
    // Registered 1 mm too high.
    std::vector<Vec3> high = press.tips;
    for (Vec3& tip : high) tip.z() += 0.001;
    EXPECT_EQ(far_from_surface(*floor(half_side_m), high, press.loads_N, 0.0, "r.csv", "m"), std::nullopt);
  }
  const auto message = far_from_surface(*floor(0.3048), press.tips, press.loads_N, 0.0, "r.csv", "ft");
  ASSERT_TRUE(message);
  EXPECT_THAT(*message, HasSubstr("--mesh-unit m "));
}

TEST(Nearness, AnotherFrameIsNotAUnit) {
  const auto surface = make_embree_surface(body(1.0));
  std::vector<Vec3> tips = path(0.0);
  for (Vec3& tip : tips) tip += Vec3(0.5, -0.7, 0.9);
  const auto message = far_from_surface(*surface, tips, {}, 0.0, "r.csv", "m");
  ASSERT_TRUE(message);
  EXPECT_THAT(*message, HasSubstr("No usual unit would make it fit"));
}

}  // namespace
}  // namespace touchstone::rendering
