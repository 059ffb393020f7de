#include "synthetic/surfaces/radial_body.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

namespace touchstone::synthetic {
namespace {

// |q| = (u' D u)^(-1/2) with D the inverse squares of the half axes.
class Ellipsoid final : public RadialFunction {
 public:
  explicit Ellipsoid(const Vec3& half_axes_m) : d_(half_axes_m.cwiseAbs2().cwiseInverse().asDiagonal()) {}
  [[nodiscard]] RadialJet jet(const Vec3& u) const override {
    const Vec3 v = d_ * u;
    const double rho = 1.0 / std::sqrt(u.dot(v));
    const double cube = rho * rho * rho;
    return {rho, -cube * v, 3.0 * cube * rho * rho * v * v.transpose() - cube * d_};
  }

 private:
  Mat3 d_;
};

// An ellipsoid with half axes a > b > c bends most at the ends of the longest: by a / c^2. The sample of directions has
// one within 0.04 rad of there.
TEST(RadialBody, BendsAsAnEllipsoidDoes) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const auto& [a, b, c] : {std::array{30.0, 20.0, 12.0}, {12.0, 11.0, 10.0}}) {
      const RadialBody body(std::make_unique<Ellipsoid>(scale * Vec3(b, a, c)));
      const double expected = a / (c * c) / scale;
      const auto curvature = body.largest_curvature();
      EXPECT_LE(curvature.convex_per_m, expected * (1.0 + 1e-9));
      EXPECT_GE(curvature.convex_per_m, 0.97 * expected);
      EXPECT_EQ(curvature.concave_per_m, 0.0);
    }
  }
}

// Of a sphere both are 1/r everywhere, to rounding.
TEST(RadialBody, BendsAsASphereDoesToRounding) {
  const RadialBody body(std::make_unique<Ellipsoid>(Vec3(0.02, 0.02, 0.02)));
  EXPECT_NEAR(body.largest_curvature().convex_per_m, 50.0, 1e-11);
}

}  // namespace
}  // namespace touchstone::synthetic
