#include "harness/perception/judge/slow_channels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace touchstone::perception {
namespace {

double force_jnd_of(double real_N, double rendered_N, double exponent, const Thresholds& thresholds) {
  const NoticeableSteps steps(thresholds.force);
  return force_at_depth_jnd(steps(rendered_N) - steps(real_N), real_N, rendered_N, exponent, thresholds);
}

// Tan, Durlach, Beauregard and Srinivasan (1995): 22 % if the depth is varied; Pang, Tan and Durlach (1991): 7 %.
TEST(ForceAtDepth, ASpringIsToldAsComplianceIsAndAConstantForceAsForceIs) {
  const Thresholds thresholds;
  for (const double times : {0.25, 1.0, 3.0}) {
    EXPECT_NEAR(force_jnd_of(4.0, 4.0 * std::pow(1.22, times), 1.0, thresholds), times, 1e-4);
    EXPECT_NEAR(force_jnd_of(4.0, 4.0 * std::pow(1.07, times), 0.0, thresholds), times, 1e-12);
  }
  // A hand that is led to the same depth compares forces.
  Thresholds led;
  led.depth_fraction = 0.0;
  EXPECT_NEAR(force_jnd_of(4.0, 4.0 * 1.07, 1.0, led), 1.0, 1e-12);
}

TEST(ForceAtDepth, NoForceAtAllIsNoQuestionOfDepth) {
  const Thresholds thresholds;
  EXPECT_NEAR(force_jnd_of(4.0, 0.0, 1.0, thresholds), NoticeableSteps(thresholds.force)(4.0), 1e-12);
  EXPECT_EQ(force_jnd_of(4.0, 4.0, 1.0, thresholds), 0.0);
}

TEST(ForceAtDepth, ExponentIsThePowerOfTheDepth) {
  const DepthGrid grid{0.001};
  ResponseCurves curves;
  for (int j = 0; j <= 10; ++j) {
    curves.normal_N.push_back(0.5 * j);
    for (auto& side : curves.side_N) side.push_back(0.0);
  }
  EXPECT_NEAR(depth_exponent(curves, 0.008, 0.001, grid), 1.0, 1e-9);
  for (double& f : curves.normal_N) f = 3.0;
  EXPECT_EQ(depth_exponent(curves, 0.008, 0.001, grid), 0.0);
  for (double& f : curves.normal_N) f = 0.0;
  EXPECT_EQ(depth_exponent(curves, 0.008, 0.001, grid), 0.0);
}

// Fehlberg et al. (2022): relative differences of friction of 0.2.
TEST(Friction, IsToldByItsOwnSizeAndBelowThatByTheLoads) {
  const Thresholds thresholds;
  EXPECT_NEAR(friction_jnd(2.0, 2.0 * 1.2, 0.4, 4.0, thresholds), 1.0, 1e-12);
  // 7 % of 4 N are noticed as a force.
  EXPECT_NEAR(friction_jnd(0.0, 0.28, 0.28, 4.0, thresholds), 1.0, 1e-12);
  EXPECT_NEAR(friction_jnd(0.0, 0.14, 0.14, 4.0, thresholds), 0.5, 1e-12);
  // Against the motion and along it: both count.
  EXPECT_GT(friction_jnd(1.0, 1.0, 2.0, 4.0, thresholds), 10.0);
  EXPECT_EQ(friction_jnd(1.0, 1.0, 0.0, 4.0, thresholds), 0.0);
  EXPECT_TRUE(std::isnan(friction_jnd(1.0, 1.0, std::numeric_limits<double>::quiet_NaN(), 4.0, thresholds)));
}

}  // namespace
}  // namespace touchstone::perception
