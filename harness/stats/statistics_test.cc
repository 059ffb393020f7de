#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "harness/base/random.h"
#include "harness/stats/all_pairs.h"
#include "harness/stats/change_points.h"
#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"
#include "harness/stats/sandwich.h"
#include "harness/stats/series_mean.h"
#include "harness/stats/simulated_noise.h"
#include "harness/stats/summary.h"
#include "harness/stats/trend.h"
#include "harness/stats/two_sample.h"

namespace touchstone::stats {
namespace {

TEST(Quantile, TypeSeven) {
  const std::vector<double> sample{4.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(quantile(sample, 0.0), 1.0);
  EXPECT_EQ(quantile(sample, 0.25), 1.75);
  EXPECT_EQ(median(sample), 2.5);
  EXPECT_EQ(quantile(sample, 1.0), 4.0);
  EXPECT_EQ(median({7.0}), 7.0);
}

// The mean of the two middle values is rounded once: 0.5 * (a + b), not a + 0.5 * (b - a).
TEST(Quantile, MedianOfAnEvenNumberIsTheNearestDouble) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double a = random.normal();
    const double b = random.normal();
    ASSERT_EQ(median({a, b}), 0.5 * (a + b));
    ASSERT_EQ(median({a, b, -1e9, 1e9}), 0.5 * (a + b));
  }
}

TEST(Quantile, ObservedValues) {
  const std::vector<double> sample{4.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(upper_median(sample), 3.0);
  EXPECT_EQ(upper_median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(lower_quantile(sample, 0.5), 2.0);
  EXPECT_EQ(lower_quantile(sample, 1.0), 4.0);
  EXPECT_EQ(reaching_quantile(sample, 0.5), 2.0);
  EXPECT_EQ(reaching_quantile(sample, 0.51), 3.0);
  EXPECT_EQ(reaching_quantile(sample, 0.0), 1.0);
  EXPECT_EQ(reaching_quantile(sample, 1.0), 4.0);
}

TEST(Quantile, NothingHasNoQuantile) {
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(upper_median({})));
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(lower_quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(reaching_quantile({}, 0.5)));
}

// Shaffer 1986, table 1: of 3, 4 and 5 things.
TEST(AllPairs, AsManyCanBeEqualAsShafferSays) {
  EXPECT_EQ(possible_equal_pairs(3), (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_EQ(possible_equal_pairs(4), (std::vector<std::size_t>{0, 1, 2, 3, 6}));
  EXPECT_EQ(possible_equal_pairs(5), (std::vector<std::size_t>{0, 1, 2, 3, 4, 6, 10}));
}

// Of four things: level / 6 for the smallest p, / 3 for the next three, then / 2 and / 1.
TEST(AllPairs, StopsAtTheFirstThatIsTooLarge) {
  const std::vector<double> p{0.02, 0.001, 0.9, 0.012, 0.016, 0.04};
  const auto verdicts = judge_all_pairs(p, 4, 0.06);
  const std::vector<double> levels{0.02, 0.01, 0.06, 0.02, 0.02, 0.03};
  const std::vector<bool> differ{true, true, false, true, true, false};
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(verdicts[i].level, levels[i], 1e-15) << i;
    EXPECT_EQ(verdicts[i].differ, differ[i]) << i;
  }
}

// White noise, and noise that is correlated over five and twenty values: at most about 5 % of the means are "not zero"
// at p = 0.05. What is correlated over a fifth of the series and more is not judged.
TEST(SeriesMean, HoldsItsLevelForCorrelatedSeries) {
  for (const double stay : {0.0, 0.8, 0.95}) {
    std::size_t found = 0;
    const Random root(1);
    for (std::uint64_t i = 0; i < 1000; ++i) {
      Random random = root.stream(i);
      std::vector<double> series;
      double now = random.normal();
      for (int k = 0; k < 400; ++k) {
        now = stay * now + std::sqrt(1.0 - stay * stay) * random.normal();
        series.push_back(now);
      }
      found += series_mean(series).p <= 0.05 ? 1 : 0;
    }
    EXPECT_LE(found, 65u) << stay;
  }
  std::vector<double> slow;
  for (int k = 0; k < 400; ++k) slow.push_back(1.0 + std::sin(0.02 * k));
  EXPECT_EQ(series_mean(slow).degrees, 0.0);
}

TEST(SeriesMean, OfAConstantIsCertainAndOfAFewValuesUnknown) {
  EXPECT_EQ(series_mean(std::vector<double>(100, 0.1)).p, 0.0);
  EXPECT_GE(series_mean(std::vector<double>(100, 0.1)).degrees, kFewestDegrees);
  EXPECT_EQ(series_mean(std::vector<double>(100, 0.0)).p, 1.0);
  EXPECT_EQ(series_mean(std::vector<double>(19, 0.1)).degrees, 0.0);
  std::vector<double> holed(100, 0.1);
  holed[50] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(series_mean(holed).p, 1.0);
}

// A mean of values in clusters of m equal copies has the variance of n / m independent values, not of n.
TEST(Sandwich, ClustersOfEqualValuesCountOnce) {
  Random random(4);
  constexpr int clusters = 50;
  constexpr int copies = 8;
  std::vector<double> values;
  for (int i = 0; i < clusters; ++i) values.push_back(random.normal());
  const double centre = mean(values);
  Eigen::MatrixXd gradients(clusters, 1);  // of the cluster's sum of (x - mean)^2 / 2
  for (int i = 0; i < clusters; ++i) gradients(i, 0) = copies * (centre - values[static_cast<std::size_t>(i)]);
  const Eigen::MatrixXd inverse = Eigen::MatrixXd::Constant(1, 1, 1.0 / (clusters * copies));
  const double spread = standard_deviation(values);
  EXPECT_NEAR(sandwich_covariance(inverse, gradients)(0, 0), spread * spread / clusters, 1e-15);
}

// The mean of noise that follows an autoregression of first order has the variance S(0) / T, many times that of white
// noise of the same spread; S(w) = 1 / (1 - 2 a cos w + a^2) (Box and Jenkins 1970, 3.2.3). Its estimate has the mean
// of S over the frequencies that it takes, within sqrt(2 / degrees of freedom / series).
TEST(Sandwich, LongRunsOfCorrelatedValuesCountForWhatTheyAre) {
  constexpr int parts = 1000, series = 400, freedom = 40;
  for (const double a : {0.0, 0.5, 0.8}) {
    Random random(5);
    double estimated = 0.0;
    for (int s = 0; s < series; ++s) {
      Eigen::MatrixXd values(parts, 1);
      double last = random.normal() / std::sqrt(1.0 - a * a);
      for (int t = 0; t < parts; ++t) values(t, 0) = last = a * last + random.normal();
      const Eigen::MatrixXd gradients = long_run_gradients(values);
      ASSERT_EQ(gradients.rows(), freedom);
      estimated += sandwich_covariance(Eigen::MatrixXd::Constant(1, 1, 1.0 / parts), gradients)(0, 0) / series;
      // What all values share is no spread.
      EXPECT_NEAR((long_run_gradients((values.array() + 7.0).matrix()) - gradients).norm(), 0.0, 1e-9);
    }
    double expected = 0.0;
    for (int j = 1; j <= freedom; ++j)
      expected += 1.0 / (1.0 - 2.0 * a * std::cos(std::numbers::pi * j / parts) + a * a) / parts / freedom;
    EXPECT_NEAR(estimated / expected, 1.0, 4.0 * std::sqrt(2.0 / (freedom * series))) << a;
    EXPECT_NEAR(expected * parts * (1.0 - a) * (1.0 - a), 1.0, 0.15) << a;
  }
}

TEST(Quantile, SpreadOfANormalIsOneAndOutliersDoNotChangeIt) {
  Random random(1);
  std::vector<double> sample(20001);
  for (double& value : sample) value = random.normal();
  EXPECT_NEAR(median_absolute_deviation(sample), 1.0, 0.03);
  for (std::size_t i = 0; i < 1000; ++i) sample[i] = 1e6;
  EXPECT_NEAR(median_absolute_deviation(sample), 1.0, 0.1);
}

// Student's own data (The probable error of a mean, 1908), pooled: t = -1.8608, 18 degrees of freedom, p = 0.07919, as
// R's t.test(extra ~ group, sleep, var.equal = TRUE) prints it.
TEST(TwoSample, StudentsSleepData) {
  const std::vector<double> one{0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
  const std::vector<double> two{1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
  EXPECT_NEAR(student_p(-1.8608, 18.0), 0.07919, 1e-5);
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
}  // namespace touchstone::stats
