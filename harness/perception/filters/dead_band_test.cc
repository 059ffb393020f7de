#include "harness/perception/filters/dead_band.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::perception {
namespace {

// A press with noise, at any scale of the law.
std::vector<double> press(Random& random, double scale, std::size_t samples) {
  std::vector<double> x;
  const double frequency = random.log_uniform(0.001, 0.02);
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n);
    x.push_back(scale * (6.0 * std::pow(std::sin(frequency * t), 2) - 0.5 + 0.02 * random.normal()));
  }
  return x;
}

TEST(DeadBand, InvariantsOverScalesAndShapes) {
  Random random(5);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const WeberLaw law{0.06 * scale, 2.5 * scale, 0.2, 0.07};
    for (int round = 0; round < 20; ++round) {
      const auto x = press(random, scale, 500);
      const auto once = dead_band(x, law);
      ASSERT_EQ(once.held.size(), x.size());
      EXPECT_EQ(once.kept.front(), 0u);
      const auto twice = dead_band(once.held, law);
      EXPECT_EQ(twice.held, once.held);  // idempotent, to the bit
      EXPECT_LT(once.kept.size(), x.size() / 2) << "sparse";
      EXPECT_DOUBLE_EQ(once.reduction(), 1.0 - static_cast<double>(once.kept.size()) / 500.0);
      for (std::size_t t = 0; t < x.size(); ++t) {
        // The error stays below what is noticed from the held value, or below the absolute threshold.
        EXPECT_LE(std::abs(x[t] - once.held[t]), law.just_noticeable_difference(once.held[t])) << t;
      }
      for (std::size_t i = 1; i < once.kept.size(); ++i) {
        EXPECT_NE(once.held[once.kept[i]], once.held[once.kept[i] - 1]) << "a kept sample that changes nothing";
      }
    }
  }
}

TEST(DeadBand, TheStepsOfARampAreWebersLaw) {
  std::vector<double> ramp;
  for (int n = 0; n <= 60000; ++n) ramp.push_back(1e-4 * n);
  const auto felt = dead_band(ramp, fingertip_force);
  EXPECT_EQ(felt.held[599], 0.0);  // below 0.06 N nothing is felt
  EXPECT_NEAR(felt.held[600], 0.06, 1e-12);
  for (std::size_t i = 2; i < felt.kept.size(); ++i) {
    const double before = felt.held[felt.kept[i - 1]];
    const double now = felt.held[felt.kept[i]];
    const double k = before > 2.5 ? 0.07 : 0.20;
    EXPECT_GE(now, before * (1.0 + k) * (1.0 - 1e-12));
    EXPECT_LT(now, before * (1.0 + k) + 1.01e-4);  // the first sample of the ramp beyond it
  }
}

TEST(DeadBand, ConstantAndSilentSeriesKeepOneSample) {
  EXPECT_EQ(dead_band(std::vector<double>(100, 3.0), fingertip_force).kept.size(), 1u);
  const auto silent = dead_band(std::vector<double>(100, 0.05), fingertip_force);
  EXPECT_EQ(silent.kept.size(), 1u);
  EXPECT_EQ(silent.held.back(), 0.0);
  EXPECT_EQ(dead_band({}, fingertip_force).reduction(), 0.0);
}

TEST(DeadBand, DisplacementTakesItsFractionFromTheForce) {
  const std::vector<double> displacement{0.010, 0.0115, 0.0115, 0.0125, 0.0125};
  const std::vector<double> light(5, 1.0);
  const std::vector<double> firm(5, 5.0);
  // 15 % of 10 mm is not noticed at 1 N (20 %) and is at 5 N (7 %).
  EXPECT_EQ(displacement_dead_band(displacement, light, fingertip_force, 0.0).kept, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(displacement_dead_band(displacement, firm, fingertip_force, 0.0).kept, (std::vector<std::size_t>{0, 1, 3}));
  const auto once = displacement_dead_band(displacement, firm, fingertip_force, 0.0);
  EXPECT_EQ(displacement_dead_band(once.held, firm, fingertip_force, 0.0).held, once.held);
  EXPECT_THROW(displacement_dead_band(displacement, std::vector<double>(4, 1.0), fingertip_force, 0.0), BadData);
}

}  // namespace
}  // namespace touchstone::perception
