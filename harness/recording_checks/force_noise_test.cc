// White noise is found in any motion that is slow against the sampling, at every scale.
#include "harness/recording_checks/force_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::recording_checks {
namespace {

TEST(ForceNoise, IsTheDeviationOfWhiteNoiseUnderPresses) {
  Random random(1);
  for (const double unit : {1e-9, 1.0, 1e4}) {
    for (const double noise_N : {0.003, 0.03}) {
      std::vector<Vec3> forces;
      for (int i = 0; i < 4000; ++i) {
        const double load_N = std::max(0.0, 2.0 * std::sin(0.03 * i));
        forces.push_back(
            unit * Vec3(noise_N * random.normal(), noise_N * random.normal(), load_N + noise_N * random.normal()));
      }
      // The largest of three estimates from 4000 samples, with 5 % of the differences over a touch or a lift-off.
      EXPECT_NEAR(force_noise_N(forces), unit * noise_N, 0.1 * unit * noise_N);
    }
  }
}

TEST(ForceNoise, IsZeroWhereNothingCanBeSaid) {
  EXPECT_EQ(force_noise_N({}), 0.0);
  EXPECT_EQ(force_noise_N(std::vector<Vec3>(15, Vec3(1, 2, 3))), 0.0);
  EXPECT_EQ(force_noise_N(std::vector<Vec3>(100, Vec3(1, 2, 3))), 0.0);
}

}  // namespace
}  // namespace touchstone::recording_checks
