// The exact answers against closed forms written out by hand, at every scale, and against the shapes themselves.
#include "synthetic/surfaces/exact_contact.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::synthetic {
namespace {

constexpr std::uint64_t seed = 1995;
constexpr double k = 500.0;

TEST(ExactContact, BallPressedOnABall) {
  Random random(seed);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto sphere = make_surface("sphere", {{"radius_m", 0.03 * scale}});
    for (int i = 0; i < 200; ++i) {
      const Vec3 u = random.direction();
      const double from_centre = random.uniform(0.02, 0.04) * scale;
      const ExactContact c = exact_contact(*sphere, from_centre * u, k, 0.002 * scale);
      const double depth = std::max(0.0, 0.032 * scale - from_centre);
      EXPECT_NEAR(c.depth_m, depth, 1e-17 * scale);
      EXPECT_LT((c.f_W_N - k * depth * u).norm(), 1e-13 * scale);
      if (c.contact) {
        EXPECT_LT((c.proxy_W_m - 0.032 * scale * u).norm(), 2e-17 * scale);
      }
    }
  }
}

TEST(ExactContact, BallInsideATube) {
  const auto torus = make_surface("torus");
  Random random(seed);
  for (int i = 0; i < 200; ++i) {
    const double around = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double about = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double from_tube = random.uniform(0.004, 0.012);
    const Vec3 out(std::cos(around) * std::cos(about), std::sin(around) * std::cos(about), std::sin(about));
    const Vec3 tip = 0.03 * Vec3(std::cos(around), std::sin(around), 0.0) + from_tube * out;
    const ExactContact c = exact_contact(*torus, tip, k, 0.001);
    EXPECT_LT((c.f_W_N - k * std::max(0.0, 0.011 - from_tube) * out).norm(), 1e-13);
  }
}

TEST(ExactContact, PointAtTheBottomOfAGroove) {
  // Between the perpendiculars of both walls the spring pulls to the edge itself.
  const auto groove = make_surface("v-groove");
  const Vec3 bottom(0.0, 0.0, -0.005);
  const Vec3 tip = bottom + Vec3(0.0003, 0.0, -0.001);
  const ExactContact c = exact_contact(*groove, tip, k, 0.0);
  EXPECT_LT((c.proxy_W_m - bottom).norm(), 1e-17);
  EXPECT_LT((c.f_W_N - k * (bottom - tip)).norm(), 1e-14);
}

struct Valley {
  Vec3 n1, n2;
  explicit Valley(double slope)
      : n1(-std::sin(slope), 0.0, std::cos(slope)), n2(std::sin(slope), 0.0, std::cos(slope)) {}
};

TEST(ExactValleyContact, AgreesWithTheShapeForAPoint) {
  Random random(seed);
  for (const double opening : {0.3, 1.0, std::numbers::pi / 2, 3.0}) {
    const auto groove = make_surface("v-groove", {{"opening_rad", opening}, {"depth_m", 0.002}, {"half_side_m", 0.2}});
    const Valley v(0.5 * (std::numbers::pi - opening));
    for (int i = 0; i < 300; ++i) {
      const Vec3 tip = Vec3(0.0, 0.0, -0.002) + random.uniform(0.0, 0.0008) * random.direction();
      const ExactContact by_shape = exact_contact(*groove, tip, k, 0.0);
      const ExactContact by_planes = exact_valley_contact({0.0, 0.0, -0.002}, v.n1, v.n2, tip, k, 0.0);
      EXPECT_LT((by_shape.f_W_N - by_planes.f_W_N).norm(), 1e-13);
    }
  }
}

TEST(ExactValleyContact, BallTouchesBothWallsAndIsTheNearestSuch) {
  Random random(seed + 1);
  for (const double slope : {1e-6, 1e-3, 0.5, 1.3}) {
    const Valley v(slope);
    const double r = 0.001;
    int both = 0;
    for (int i = 0; i < 2000; ++i) {
      // Around the place of the ball that touches both.
      const Vec3 rest(0.0, 0.0, r / std::cos(slope));
      const double reach = random.log_uniform(1e-6, 1e-3);
      const Vec3 tip = rest + reach * random.direction().cwiseProduct(Vec3(std::sin(slope), 1.0, 1.0));
      const ExactContact c = exact_valley_contact(Vec3::Zero(), v.n1, v.n2, tip, k, r);
      const double g1 = v.n1.dot(c.proxy_W_m) - r;
      const double g2 = v.n2.dot(c.proxy_W_m) - r;
      const double rounding = 1e-15 * (r + reach);
      EXPECT_GT(std::min(g1, g2), -rounding);
      if (!c.contact) continue;
      EXPECT_LT((c.f_W_N - k * (c.proxy_W_m - tip)).norm(), k * rounding);
      // Karush, Kuhn and Tucker: planes push, do not pull, and only those that are touched.
      const double up = c.f_W_N.z() * std::sin(slope);
      const double sideways = c.f_W_N.x() * std::cos(slope);
      EXPECT_LE(std::abs(sideways), up + k * rounding);
      if (g1 > rounding) {
        EXPECT_NEAR(sideways, up, k * rounding);
      }
      if (g2 > rounding) {
        EXPECT_NEAR(sideways, -up, k * rounding);
      }
      both += std::abs(sideways) < up - k * rounding ? 1 : 0;
    }
    EXPECT_GT(both, 100) << "slope " << slope;
  }
}

// The closest point is the god-object's as long as it follows the tip: on one side of a body, not past its middle.
TEST(ExactContact, LeavesTheSheetPastTheMiddleOfABody) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto sphere = make_surface("sphere", {{"radius_m", 0.03 * scale}});
    const auto at = [&](double x, double z) { return Vec3(x * scale, 0.0, z * scale); };
    EXPECT_FALSE(leaves_sheet(*sphere, at(0.0, 0.031), at(0.0, 0.028), 0.0)) << "in";
    EXPECT_FALSE(leaves_sheet(*sphere, at(0.0, 0.028), at(0.005, 0.028), 0.0)) << "along";
    EXPECT_FALSE(leaves_sheet(*sphere, at(0.0, 0.028), at(0.0, 0.028), 0.0)) << "at rest";
    EXPECT_FALSE(leaves_sheet(*sphere, at(0.0, 0.05), at(0.05, 0.0), 0.001 * scale)) << "outside, far";
    EXPECT_TRUE(leaves_sheet(*sphere, at(0.0, 0.028), at(0.0, -0.028), 0.0)) << "through the middle";
    EXPECT_TRUE(leaves_sheet(*sphere, at(0.0, 0.031), at(0.0, -0.031), 0.0)) << "through, free before and after";
    EXPECT_TRUE(leaves_sheet(*sphere, at(-0.0005, 0.001), at(0.0005, 0.001), 0.0)) << "close by the middle";
  }
}

}  // namespace
}  // namespace touchstone::synthetic
