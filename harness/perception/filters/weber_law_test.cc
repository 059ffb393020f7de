#include "harness/perception/filters/weber_law.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/perception/filters/sensor_dead_zone.h"
#include "harness/perception/filters/stevens_power_law.h"

namespace touchstone::perception {
namespace {

TEST(WeberLaw, ThePapersConstants) {
  EXPECT_DOUBLE_EQ(fingertip_force.just_noticeable_difference(1.0), 0.2);
  EXPECT_DOUBLE_EQ(fingertip_force.just_noticeable_difference(-1.0), 0.2);
  EXPECT_DOUBLE_EQ(fingertip_force.just_noticeable_difference(5.0), 0.35);
  EXPECT_DOUBLE_EQ(fingertip_force.just_noticeable_difference(0.0), 0.06);
  EXPECT_DOUBLE_EQ(fingertip_force.fraction(2.5), 0.20);
  EXPECT_DOUBLE_EQ(fingertip_force.fraction(2.5001), 0.07);
}

TEST(WeberLaw, OneStepIsOneJustNoticeableDifference) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const WeberLaw law{0.06 * scale, 2.5 * scale, 0.20, 0.07};
    for (int i = 0; i < 515; ++i) {
      const double intensity = 0.06 * scale * std::pow(1.01, i);  // to 9.98
      const double next = intensity + law.just_noticeable_difference(intensity);
      if (intensity <= 2.5 * scale && next > 2.5 * scale) continue;  // the step over the break holds both fractions
      EXPECT_NEAR(law.steps(next) - law.steps(intensity), 1.0, 1e-9) << intensity;
    }
    EXPECT_DOUBLE_EQ(law.steps(0.06 * scale), 1.0);
    EXPECT_DOUBLE_EQ(law.steps(-3.0 * scale), -law.steps(3.0 * scale));
    EXPECT_NEAR(law.steps(2.5 * scale * (1.0 + 1e-12)), law.steps(2.5 * scale), 1e-9);  // continuous at the break
  }
}

TEST(StevensPowerLaw, KnownValuesAndInverse) {
  const StevensPowerLaw square{2.0, 2.0};
  EXPECT_DOUBLE_EQ(square(3.0), 18.0);
  EXPECT_DOUBLE_EQ(square(-3.0), -18.0);
  const StevensPowerLaw muscle{0.7, stevens_muscle_force};
  for (const double force : {1e-3, 0.5, 4.0, 1e3}) EXPECT_NEAR(muscle.inverse(muscle(force)), force, 1e-12 * force);
  // Equal ratios of the stimulus are equal ratios of the feeling: what the law says.
  EXPECT_NEAR(muscle(4.0) / muscle(2.0), muscle(400.0) / muscle(200.0), 1e-12);
}

TEST(SensorDeadZone, ReadsNothingBelowIt) {
  EXPECT_EQ(sensor_dead_zone(std::vector<double>{0.59, -0.59, 0.6, 2.0}, 0.6), (std::vector<double>{0, 0, 0.6, 2.0}));
}

}  // namespace
}  // namespace touchstone::perception
