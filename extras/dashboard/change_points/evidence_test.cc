#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "change_points/change_points.h"
#include "change_points/simulated_noise.h"
#include "change_points/trend.h"
#include "change_points/two_sample.h"
#include "harness/base/random.h"
#include "harness/stats/distributions.h"

namespace touchstone::change_points {
namespace {

// Student's own data (The probable error of a mean, 1908), pooled: t = -1.8608, 18 degrees of freedom, p = 0.07919, as
// R's t.test(extra ~ group, sleep, var.equal = TRUE) prints it.
TEST(TwoSample, StudentsSleepData) {
  const std::vector<double> one{0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
  const std::vector<double> two{1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
  EXPECT_NEAR(stats::student_p(-1.8608, 18.0), 0.07919, 1e-5);
  const TwoSample test = pooled_t_test(one, two, 0.0);
  EXPECT_NEAR(test.before, 0.75, 1e-12);
  EXPECT_NEAR(test.after, 2.33, 1e-12);
  EXPECT_GE(test.p, 0.07919 - 1e-5) << "the autocorrelation only ever weakens the evidence";
}

TEST(TwoSample, AFewOutliersAreNoEvidence) {
  std::vector<double> before;
  std::vector<double> after;
  Random random(2);
  for (int i = 0; i < 30; ++i) before.push_back(random.normal());
  for (int i = 0; i < 3; ++i) after.push_back(10.0 + random.normal());
  EXPECT_LT(pooled_t_test_without(before, after, 2, 0.0).p, 1e-8);
  after[0] = 0.0;
  EXPECT_GT(pooled_t_test_without(before, after, 2, 0.0).p, 1e-3);
  EXPECT_EQ(pooled_t_test_without(before, {after.begin(), 2}, 2, 0.0).p, 1.0);
}

TEST(TwoSample, RoundingIsNoDifference) {
  const std::vector<double> before(5, 1.0);
  const std::vector<double> after(5, 1.0 + 1e-14);
  EXPECT_EQ(pooled_t_test(before, after, 1e-13).p, 1.0);
  EXPECT_EQ(pooled_t_test(before, std::vector<double>(5, 1.1), 1e-13).p, 0.0);
}

// The score is counted here pair by pair; its variance without ties is n (n - 1) (2 n + 5) / 18.
TEST(Trend, KendallsScoreAgainstCountedPairs) {
  const std::vector<double> values{2.6, 3.1, 2.5, 5.0, 3.6, 4.0, 5.2, 2.8, 3.8};
  double score = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = i + 1; j < values.size(); ++j) score += values[j] > values[i] ? 1.0 : -1.0;
  }
  const double z = (score - 1.0) / std::sqrt(9.0 * 8.0 * 23.0 / 18.0);
  EXPECT_NEAR(find_trend(values).p, std::erfc(z / std::sqrt(2.0)), 1e-12);
}

TEST(Trend, TheLineIsFoundUnderOutliers) {
  std::vector<double> values(50);
  Random random(3);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = 5.0 - 0.1 * static_cast<double>(i) + 0.05 * random.normal();
  values[7] = 100.0;
  const Trend trend = find_trend(values);
  EXPECT_NEAR(trend.slope, -0.1, 0.002);
  EXPECT_NEAR(trend.intercept, 5.0, 0.05);
  EXPECT_LT(trend.p, 1e-10);
  EXPECT_EQ(find_trend(std::vector<double>(20, 1.0)).p, 1.0);
}

TEST(Trend, SquaresAboutALineAgainstTheLineItself) {
  EXPECT_NEAR(squares_about_line(std::vector<double>{1.0, 3.0, 5.0, 7.0}), 0.0, 1e-20);
  EXPECT_NEAR(squares_about_line(std::vector<double>{0.0, 1.0, 0.0}), 2.0 / 3.0, 1e-12);
}

// Each noise over 5 years, looked at every month: at 1 % a year, three alarms or more have probability 0.8 %.
TEST(FalseAlarms, NoiseAloneRarelyShowsAChange) {
  int alarms = 0;
  for (const std::string_view noise : noises) {
    for (std::uint64_t year = 0; year < 5; ++year) {
      Random random(year);
      const auto values = series_of(noise, 365, random);
      bool alarm = false;
      for (std::size_t day = 30; day <= values.size(); day += 30)
        alarm = alarm || !find_changes(std::span(values).first(day), {.smallest_relative = 0.0}).changes.empty();
      alarms += alarm ? 1 : 0;
    }
  }
  EXPECT_LT(alarms, 3);
}

}  // namespace
}  // namespace touchstone::change_points
