#include "tool_renderers/distance_bounds.h"

#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::tool_renderers {
namespace {

// Points that wander about a body, through it and far from it: no decision differs from that of the distance itself,
// and few are asked for.
void expect_right_decisions(const surface::TriangleMesh& mesh, double size, const Vec3& at, double most_asked) {
  const std::shared_ptr<const surface::Surface> surface =
      make_embree_surface(surface::moved(mesh, Quat(0.83, 0.31, -0.41, 0.22).normalized(), at, 1.0));
  constexpr std::size_t points = 40;
  constexpr int steps = 500;
  DistanceBounds bounds(surface, points);
  Random random(7);
  std::vector<Vec3> p;
  std::vector<double> radius;
  for (std::size_t i = 0; i < points; ++i) {
    p.push_back(at + random.log_uniform(0.1, 2.0) * size * random.direction());
    radius.push_back(i % 2 == 0 ? 0.0 : random.uniform(0.0, 0.2) * size);
  }
  std::size_t asked = 0;
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < points; ++i) {
      const double s = surface->signed_distance(p[i]);
      auto side = bounds.side(i, p[i], radius[i]);
      if (side == DistanceBounds::Side::unknown) {
        ++asked;
        ASSERT_EQ(bounds.ask(i, p[i]).signed_distance_m, s);
      } else {
        ASSERT_EQ(side == DistanceBounds::Side::beyond, s > radius[i]) << "step " << step << " point " << i;
      }
      p[i] += 1e-2 * size * random.direction();
    }
  }
  EXPECT_LT(static_cast<double>(asked), most_asked * points * steps);
  EXPECT_GT(asked, points);
  bounds.forget();
  EXPECT_EQ(bounds.side(0, p[0], 0.0), DistanceBounds::Side::unknown);
}

TEST(DistanceBounds, DecideAsTheDistanceDoesAtEveryScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const double shift : {0.0, 30.0}) {
      SCOPED_TRACE(::testing::Message() << scale << " " << shift);
      const Vec3 at = shift * scale * Vec3(1, -2, 3);
      expect_right_decisions(testing::cube(scale), scale, at, 0.2);
      expect_right_decisions(testing::torus(scale, 0.4 * scale, 24, 12), scale, at, 0.2);
    }
  }
}

// Round its rim the sign of an open sheet jumps.
TEST(DistanceBounds, AskEveryTimeOfAnOpenMesh) {
  expect_right_decisions(testing::grid(1.0, 4), 1.0, Vec3::Zero(), 1.01);
}

}  // namespace
}  // namespace touchstone::tool_renderers
