#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::surface {
namespace {

using testing::ball;
using testing::grid;
using testing::torus;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Against the shapes that the meshes stand for: the difference is the tessellation's deviation, which is known.
TEST(EmbreeAgainstAnalytic, PlaneSphereAndTorus) {
  Random random(9);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Quat rotation = random.rotation();
    const Vec3 shift = 10.0 * scale * random.direction();
    const auto plane = make_embree_surface(moved(grid(1.0, 10), rotation, shift, scale));
    const auto sphere = make_embree_surface(moved(ball(1.0, 4), rotation, shift, scale));
    const auto ring = make_embree_surface(moved(torus(1.0, 0.4, 64, 48), rotation, shift, scale));
    // The mesh of the ball lies within the sphere, at its deepest in the middle of the largest triangle.
    double deepest = 0.0;
    const TriangleMesh unit_ball = ball(1.0, 4);
    for (std::size_t t = 0; t < unit_ball.triangles.size(); ++t) {
      const Vec3 n = unit_ball.scaled_normal(t).normalized();
      deepest =
          std::max(deepest, 1.0 - n.dot(unit_ball.vertices_W_m[static_cast<std::size_t>(unit_ball.triangles[t][0])]));
    }
    const double ring_deviation =
        1.4 * (1.0 - std::cos(std::numbers::pi / 64)) + 0.4 * (1.0 - std::cos(std::numbers::pi / 48));
    for (int i = 0; i < 300; ++i) {
      const Vec3 body = Vec3(random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9));
      const Vec3 q = rotation * (scale * body) + shift;
      const double tolerance = 32.0 * epsilon * 12.0 * scale;
      // Over the middle of the sheet the plane is closer than the border.
      EXPECT_NEAR(plane->closest(q).distance_m, std::abs(body.z()) * scale, tolerance);
      EXPECT_TRUE(std::abs(body.z()) < 1e-6 || (plane->signed_distance(q) > 0.0) == (body.z() > 0.0));
      const double s = scale * (body.norm() - 1.0);
      EXPECT_GE(sphere->signed_distance(q), s - tolerance);
      EXPECT_LE(sphere->signed_distance(q), s + scale * deepest + tolerance);
      const double around = std::hypot(body.x(), body.y()) - 1.0;
      const double r = scale * (std::hypot(around, body.z()) - 0.4);
      EXPECT_NEAR(ring->signed_distance(q), r, 2.0 * scale * ring_deviation + tolerance);
    }
  }
}

}  // namespace
}  // namespace touchstone::surface
