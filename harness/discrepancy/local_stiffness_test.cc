#include "harness/discrepancy/local_stiffness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::discrepancy {
using rendering::Prediction;

namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Prediction pressed(const std::vector<double>& depth_m, const std::vector<double>& load_N) {
  Prediction prediction;
  prediction.depth_m = depth_m;
  prediction.normal_N = load_N;
  prediction.n_W.assign(depth_m.size(), Vec3::UnitZ());
  return prediction;
}

TEST(LocalStiffness, OfASpringIsTheSprings) {
  const Prediction spring = pressed({1e-3, 2e-3, 3e-3}, {0.5, 1.0, 1.5});
  const auto samples = pressing_samples(spring, 1);
  EXPECT_THAT(samples, ElementsAre(0, 1, 2));
  EXPECT_THAT(stiffness_at(spring, samples), ElementsAre(500.0, 500.0, 500.0));
}

TEST(LocalStiffness, ADamperThatPressesWithoutDepthIsNoStiffSpring) {
  // The last two: a damper presses at no depth; an arm that gives way takes nearly all of the load of a deep tip.
  const Prediction damped = pressed({1e-3, 2e-3, 3e-3, 1e-19, 2e-3}, {0.5, 1.0, 1.5, 0.3, 1e-16});
  EXPECT_THAT(stiffness_at(damped, pressing_samples(damped, 1)),
              ElementsAre(500.0, 500.0, 500.0, 1500.0, ::testing::DoubleEq(500.0 / 3.0)));
}

TEST(LocalStiffness, LooksWhereTheTipPressesAlone) {
  Prediction some = pressed({1e-3, 0.0, 1e-3, 1e-3, 1e-3}, {1.0, 1.0, 0.0, 1.0, 1.0});
  some.n_W[3].setZero();
  EXPECT_THAT(pressing_samples(some, 1), ElementsAre(0, 4));
  EXPECT_THAT(pressing_samples(some, 2), ElementsAre(0, 4));
  EXPECT_THAT(pressing_samples(some, 3), ElementsAre(0));
  EXPECT_THAT(stiffness_at(some, {}), IsEmpty());
}

}  // namespace
}  // namespace touchstone::discrepancy
