#include "harness/perception/agreement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
namespace {

TEST(Statistics, KnownValues) {
  EXPECT_NEAR(stats::normal_cdf(1.959963984540054), 0.975, 1e-12);
  EXPECT_NEAR(stats::normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(stats::chi_squared_tail(3.841458820694124, 1.0), 0.05, 1e-12);
  EXPECT_NEAR(stats::chi_squared_tail(18.307038053275146, 10.0), 0.05, 1e-12);
  EXPECT_NEAR(stats::student_t_975(5.0), 2.5705818366147395, 1e-9);
  EXPECT_EQ(stats::median({3, 1, 2}), 2.0);
  EXPECT_EQ(stats::median({4, 1, 2, 3}), 2.5);
  EXPECT_TRUE(std::isnan(stats::median({})));
  EXPECT_EQ(stats::ranks(std::vector<double>{10, 30, 20, 20}), (std::vector<double>{1, 4, 2.5, 2.5}));
}

TEST(RankCorrelation, KnownCases) {
  const std::vector<double> x{1, 2, 3, 4, 5, 6};
  const auto perfect = spearman(x, std::vector<double>{2, 4, 8, 16, 32, 64});
  EXPECT_DOUBLE_EQ(perfect.coefficient, 1.0);
  EXPECT_DOUBLE_EQ(perfect.p_two_sided, 2.0 / 720.0);  // one order of 720 agrees fully, one disagrees fully
  EXPECT_DOUBLE_EQ(kendall(x, std::vector<double>{6, 5, 4, 3, 2, 1}).coefficient, -1.0);
  // Neighbours swapped: d^2 sums to 2 and one pair of 15 is discordant.
  const std::vector<double> y{1, 2, 4, 3, 5, 6};
  EXPECT_NEAR(spearman(x, y).coefficient, 1.0 - 6.0 * 2.0 / (6.0 * 35.0), 1e-12);
  EXPECT_NEAR(kendall(x, y).coefficient, 1.0 - 2.0 / 15.0, 1e-12);
  // Critical value of the tables for n = 6: rho = 0.886 is the 5 % point, two-sided.
  EXPECT_LT(spearman(x, std::vector<double>{2, 1, 3, 4, 6, 5}).p_two_sided, 0.05);
  EXPECT_GT(spearman(x, std::vector<double>{2, 1, 4, 3, 6, 5}).p_two_sided, 0.05);
}

// Of x three of ten pairs are tied, of y one: tau-b is 6 concordant less none over the root of 7 times 9 (M. G.
// Kendall, Biometrika 33(3), 1945).
TEST(RankCorrelation, PairsThatAreTiedInEitherSeriesCountInNeither) {
  const std::vector<double> x{1, 1, 1, 2, 3};
  const std::vector<double> y{1, 2, 3, 4, 4};
  EXPECT_NEAR(kendall(x, y).coefficient, 6.0 / std::sqrt(7.0 * 9.0), 1e-12);
  EXPECT_NEAR(kendall(y, x).coefficient, 6.0 / std::sqrt(7.0 * 9.0), 1e-12);
}

// Beyond eight values the p of Kendall's tau is that of a normal with the variance of tau over all orders. That
// variance is counted here: the number of orders with k inversions, place by place (Knuth, The Art of Computer
// Programming 3, section 5.1.1).
TEST(RankCorrelation, KendallsPHasTheVarianceOverAllOrders) {
  for (const std::size_t n : {9U, 12U, 20U}) {
    std::vector<double> orders{1.0};  // share of the orders of i values with k inversions
    for (std::size_t i = 2; i <= n; ++i) {
      std::vector<double> next(orders.size() + i - 1, 0.0);
      for (std::size_t k = 0; k < orders.size(); ++k) {
        for (std::size_t added = 0; added < i; ++added) next[k + added] += orders[k] / static_cast<double>(i);
      }
      orders = next;
    }
    const double pairs = 0.5 * static_cast<double>(n * (n - 1));
    double variance = 0.0;
    for (std::size_t k = 0; k < orders.size(); ++k)
      variance += orders[k] * std::pow(1.0 - 2.0 * static_cast<double>(k) / pairs, 2);

    std::vector<double> x;
    for (std::size_t i = 0; i < n; ++i) x.push_back(static_cast<double>(i));
    auto y = x;
    std::reverse(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(n / 2));
    const auto found = kendall(x, y);
    EXPECT_NEAR(found.p_two_sided, std::erfc(std::abs(found.coefficient) / std::sqrt(2.0 * variance)), 1e-9) << n;
  }
}

TEST(RankCorrelation, IntervalsCoverTheTruth) {
  // Bivariate normal with correlation r: rho = 6 / pi asin(r / 2).
  const double r = 0.6;
  const double rho = 6.0 / 3.14159265358979 * std::asin(0.5 * r);
  Random random(17);
  int covered = 0;
  const int rounds = 1000;
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> x;
    std::vector<double> y;
    for (int i = 0; i < 30; ++i) {
      x.push_back(random.normal());
      y.push_back(r * x.back() + std::sqrt(1.0 - r * r) * random.normal());
    }
    const auto found = spearman(x, y);
    covered += found.low95 <= rho && rho <= found.high95 ? 1 : 0;
  }
  EXPECT_GT(covered, 0.92 * rounds);
  EXPECT_LT(covered, 0.98 * rounds);
}

TEST(RankCorrelation, TooFewConstantAndNotFinite) {
  const std::vector<double> x{1, 2, 3};
  EXPECT_EQ(spearman(x, x).low95, -1.0);  // three values say nothing about the interval
  EXPECT_TRUE(std::isnan(spearman(x, std::vector<double>{2, 2, 2}).coefficient));
  EXPECT_EQ(spearman(x, std::vector<double>{2, 2, 2}).p_two_sided, 1.0);
  EXPECT_THROW(spearman(x, std::vector<double>{1, 2}), BadData);
  EXPECT_THROW(kendall(std::vector<double>{1, 2}, std::vector<double>{1, 2}), BadData);
  EXPECT_THROW(kendall(x, std::vector<double>{1, 2, std::nan("")}), BadData);
}

}  // namespace
}  // namespace touchstone::perception
