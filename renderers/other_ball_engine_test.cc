// The scorecard held against an engine that is not Touchstone's: Bullet's narrow phase behind examples/bullet. What the
// scorecard says of it is found here without the scorecard, from the force at single places, whose right values are in
// closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "harness/plugin/plugin.h"
#include "harness/renderer_faults/diagnosis.h"
#include "harness/renderer_faults/entry_engine.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::renderers {
namespace {

constexpr double stiffness_N_per_m = 500.0, radius_m = 2.5e-3, half_m = 0.1;

class OtherBallEngine : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const library = std::getenv("TOUCHSTONE_BULLET_PLUGIN");
    if (library == nullptr)
      GTEST_SKIP() << "Bullet in double precision (Debian: libbullet-dev) was not found when the build was configured";
    plugin::PluginOptions options;
    options.in_process = true;
    const auto entries = plugin::load_plugin(library, options);
    ASSERT_EQ(entries.size(), 1U);
    engine = renderer_faults::engine_of(*entries.front(), {});
    renderer = engine.make(surface::make_embree_surface(testing::cube(half_m)), 1.0);
    renderer->reset();
  }
  // The ball's centre so far above the middle of the upper face, or of its edge, and so far outside of that.
  Vec3 force(double above_m, double x_m) {
    return renderer->step({t_s += 1e-3, Vec3(x_m, 0.007, half_m + above_m), Quat::Identity()}).f_W_N;
  }
  renderer_faults::Engine engine;
  std::unique_ptr<rendering::Renderer> renderer;
  double t_s = 0.0;
};

TEST_F(OtherBallEngine, IsRightOnAFaceAndOverASharpEdgeUntilItsCentreIsInside) {
  for (const double depth_m : {1e-5, 0.5e-3, 2.4e-3})
    EXPECT_NEAR((force(radius_m - depth_m, 0.013) - Vec3(0, 0, stiffness_N_per_m * depth_m)).norm(), 0.0, 1e-9);
  for (const double outside_m : {1e-6, 0.5e-3, 1e-3}) {
    const double above_m = 1.5e-3, distance_m = std::hypot(outside_m, above_m);
    const Vec3 away = Vec3(outside_m, 0, above_m) / distance_m;
    EXPECT_NEAR((force(above_m, half_m + outside_m) - stiffness_N_per_m * (radius_m - distance_m) * away).norm(), 0.0,
                1e-9);
  }
}

// It knows triangles and no inside: deeper than its radius the ball is pushed further in, and then not at all.
TEST_F(OtherBallEngine, FallsThroughABlockAndTheScorecardSaysSo) {
  for (const double depth_m : {2.6e-3, 4e-3, 4.9e-3})
    EXPECT_NEAR(force(radius_m - depth_m, 0.013).z(), -stiffness_N_per_m * (2.0 * radius_m - depth_m), 1e-9);
  EXPECT_EQ(force(radius_m - 5.1e-3, 0.013), Vec3::Zero());

  const renderer_faults::Diagnosis found =
      renderer_faults::diagnose(engine, {"falls-through-block", "ball-at-edge", "delay"});
  ASSERT_EQ(found.findings.size(), 2U);
  EXPECT_EQ(found.findings[0].name, "falls-through-block");
  EXPECT_EQ(found.findings[1].name, "ball-at-edge");
  EXPECT_EQ(found.findings[1].follows_from, "falls-through-block");
  EXPECT_THAT(found.clean, ::testing::ElementsAre("delay"));
}

}  // namespace
}  // namespace touchstone::renderers
