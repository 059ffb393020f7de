#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "harness/base/random.h"
#include "harness/stats/all_pairs.h"
#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"
#include "harness/stats/sandwich.h"
#include "harness/stats/series_mean.h"
#include "harness/stats/summary.h"

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
  EXPECT_GE(series_mean(std::vector<double>(100, 0.1)).degrees, fewest_degrees);
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

}  // namespace
}  // namespace touchstone::stats
