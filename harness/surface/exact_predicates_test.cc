// The filters against exact arithmetic, on points in, near and far from a plane.
#include "harness/surface/exact_predicates.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

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

// Points on a grid, every other fourth one in the plane of the first three: the determinant of whole numbers is exact
// in 64 bits.
TEST(ExactPredicates, OnAGridTheyAreThoseOfWholeNumbers) {
  using Whole = std::array<std::int64_t, 3>;
  Random random(18);
  const auto whole = [&](double most) { return static_cast<std::int64_t>(random.uniform(-most, most)); };
  const auto difference = [](const Whole& b, const Whole& a) { return Whole{b[0] - a[0], b[1] - a[1], b[2] - a[2]}; };
  int in_plane = 0;
  for (int i = 0; i < 20000; ++i) {
    const double most = 1 << 14;
    const Whole a{whole(most), whole(most), whole(most)};
    const Whole b{whole(most), whole(most), whole(most)};
    // Every fifth triangle lies across an axis.
    const Whole c{whole(most), whole(most), i % 5 == 0 && a[2] == b[2] ? a[2] : whole(most)};
    const std::int64_t m = whole(4.0);
    const std::int64_t n = whole(4.0);
    Whole d{};
    for (std::size_t k = 0; k < 3; ++k) d[k] = a[k] + m * (b[k] - a[k]) + n * (c[k] - a[k]);
    if (i % 2 == 0) d[static_cast<std::size_t>(i / 2 % 3)] += 1 - 2 * (i / 6 % 2);
    const Whole u = difference(b, a);
    const Whole v = difference(c, a);
    const Whole w = difference(d, a);
    const std::int64_t volume =
        u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
    const int expected = (volume > 0 ? 1 : 0) - (volume < 0 ? 1 : 0);
    in_plane += expected == 0 ? 1 : 0;
    for (const double scale : {1.0, 0x1p-30, 0x1p40}) {
      const auto point = [&](const Whole& x) {
        return Vec3(scale * static_cast<double>(x[0]), scale * static_cast<double>(x[1]),
                    scale * static_cast<double>(x[2]));
      };
      ASSERT_EQ(side_of_plane_exact(point(a), point(b), point(c), point(d)), expected) << i;
      ASSERT_EQ(side_of_plane(point(a), point(b), point(c), point(d)), expected) << i;
    }
  }
  EXPECT_GT(in_plane, 9000);
}

// Differences that are rounded: a corner beside the origin, so that b - a has more digits than a double.
TEST(ExactPredicates, WhereDifferencesAreRoundedTheyAreExactToo) {
  const Vec3 a(0x1p-80, 0x1p-80, 0x1p-80);
  const Vec3 b(1.0, 0.0, 0.0);
  const Vec3 c(0.0, 1.0, 0.0);
  // The plane through a, b and c has z = 2^-80 (1 - x - y) / (1 - 2^-79): at x = y = 1/4 a little more than 2^-81.
  EXPECT_EQ(side_of_plane_exact(a, b, c, Vec3(0.25, 0.25, 0x1p-81)), -1);
  EXPECT_EQ(side_of_plane_exact(a, b, c, Vec3(0.25, 0.25, 0x1p-81 + 0x1p-120)), 1);
  EXPECT_EQ(side_of_plane_exact(a, b, c, Vec3(0.0, 0.0, 0x1p-80)), -1);
  EXPECT_EQ(side_of_plane_exact(a, b, c, Vec3(0.5, 0.5, 0.0)), 0);
}

// A flat part across an axis: in it whatever the other coordinates are.
TEST(ExactPredicates, APlaneAcrossAnAxis) {
  Random random(19);
  for (int i = 0; i < 1000; ++i) {
    const double z = random.log_uniform(1e-6, 1e3);
    const auto on_it = [&] { return Vec3(random.uniform(), random.uniform(), z); };
    const Vec3 a = on_it();
    const Vec3 b = on_it();
    const Vec3 c = on_it();
    EXPECT_EQ(side_of_plane_exact(a, b, c, on_it()), 0);
    const int up = side_of_plane_exact(a, b, c, on_it() + Vec3(0, 0, 1.0));
    EXPECT_EQ(up, (b - a).cross(c - a).z() > 0.0 ? 1 : -1);
    Vec3 next = on_it();
    next.z() = std::nextafter(z, 2.0 * z);
    EXPECT_EQ(side_of_plane_exact(a, b, c, next), up);
  }
}

TEST(ExactPredicates, APlaneAndPointsByHand) {
  const PlaneFilter plane({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(plane.side({0.3, 0.3, 1e-300}), 1);
  EXPECT_EQ(plane.side({0.3, 0.3, -1.0}), -1);
  EXPECT_EQ(plane.side({5.0, -7.0, 0.0}), 0);
}

}  // namespace
}  // namespace touchstone::surface
