// The filters against exact arithmetic, on points in, near and far from a plane.
#include "harness/surface/exact_predicates.h"

#include <gtest/gtest.h>

#include "harness/base/random.h"

namespace touchstone::surface {
namespace {

TEST(ExactPredicates, FiltersAnswerOnlyWhatExactArithmeticDoes) {
  Random random(17);
  int undecided = 0;
  int decided = 0;
  for (int i = 0; i < 200000; ++i) {
    const double scale = random.log_uniform(1e-3, 1e3);
    const Vec3 offset = random.log_uniform(1e-3, 1e3) * random.direction();
    const auto anywhere = [&] { return Vec3(offset + scale * random.uniform() * random.direction()); };
    const Vec3 a = anywhere();
    const Vec3 b = anywhere();
    // Every third triangle a sliver.
    const Vec3 c = i % 3 == 0
                       ? Vec3(a + random.uniform() * (b - a) + random.log_uniform(1e-17, 1e-3) * (anywhere() - a))
                       : anywhere();
    // In the plane to rounding, and off it by anything from less than that.
    const Vec3 d = a + random.uniform(-2.0, 2.0) * (b - a) + random.uniform(-2.0, 2.0) * (c - a) +
                   scale * random.log_uniform(1e-19, 1.0) * random.direction();
    const int exact = side_of_plane_exact(a, b, c, d);
    ASSERT_EQ(side_of_plane(a, b, c, d), exact);
    const int side = PlaneFilter(a, b, c).side(d);
    if (side == 0) {
      ++undecided;
    } else {
      ++decided;
      ASSERT_EQ(side, exact) << i;
    }
  }
  EXPECT_GT(undecided, 1000);
  EXPECT_GT(decided, 100000);
}

TEST(ExactPredicates, APlaneAndPointsByHand) {
  const PlaneFilter plane({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(plane.side({0.3, 0.3, 1e-300}), 1);
  EXPECT_EQ(plane.side({0.3, 0.3, -1.0}), -1);
  EXPECT_EQ(plane.side({5.0, -7.0, 0.0}), 0);
}

}  // namespace
}  // namespace touchstone::surface
