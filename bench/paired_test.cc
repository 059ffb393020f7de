#include "bench/paired.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::bench {
namespace {

TEST(Paired, TheTestIsThatOfTheTables) {
  // Hollander, Wolfe and Chicken, table A.4: for n = 5, P(T+ >= 15) = 1/32; for n = 8, P(T+ >= 30) = 0.055 (14/256).
  EXPECT_DOUBLE_EQ(compare_paired(std::vector<double>(5, 1.0), std::vector<double>{2, 3, 4, 5, 6}, 0.95).p, 2.0 / 32.0);
  // Signs of ranks 1 to 8 in this order; the ranks of the negative ones sum to 6.
  std::vector<double> after;
  for (const int rank : {1, -2, 3, -4, 5, 6, 7, 8}) after.push_back(std::exp(rank));
  EXPECT_NEAR(compare_paired(std::vector<double>(8, 1.0), after, 0.95).p, 2.0 * 14.0 / 256.0, 1e-15);
}

TEST(Paired, AKnownRatioIsFoundWhateverTheMachineDoes) {
  Random random(20260401);
  for (const double ratio : {0.5, 0.97, 1.0, 1.03, 2.0}) {
    std::vector<double> before;
    std::vector<double> after;
    for (int i = 0; i < 20; ++i) {
      const double load = random.log_uniform(1.0, 5.0);  // slows both
      before.push_back(load * (1.0 + 0.005 * random.normal()));
      after.push_back(load * ratio * (1.0 + 0.005 * random.normal()));
    }
    const auto found = compare_paired(before, after, 0.95);
    EXPECT_NEAR(found.ratio, ratio, 0.01 * ratio);
    EXPECT_LT(found.high / found.low, 1.02);
    if (ratio != 1.0) {
      EXPECT_LT(found.p, 1e-4);
    }
  }
}

// The interval holds the truth as often as it says, for noise of heavy tails.
TEST(Paired, TheIntervalCoversAsOftenAsItSays) {
  Random random(7);
  int covered = 0;
  int significant = 0;
  constexpr int trials = 2000;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> before(12, 1.0);
    std::vector<double> after;
    for (int i = 0; i < 12; ++i)
      after.push_back(1.1 * std::exp(0.02 * random.normal() / std::max(0.05, random.uniform())));
    const auto found = compare_paired(before, after, 0.9);
    covered += found.low <= 1.1 && 1.1 <= found.high ? 1 : 0;
    std::vector<double> same;
    for (const double value : after) same.push_back(value / 1.1);
    significant += compare_paired(before, same, 0.9).p <= 0.05 ? 1 : 0;
  }
  EXPECT_GE(covered, trials * 88 / 100);
  EXPECT_LE(covered, trials * 95 / 100);
  EXPECT_LE(significant, trials * 65 / 1000);
}

TEST(Paired, EqualSeriesAndTooFewPairsSayNothing) {
  const std::vector<double> series{1, 2, 3};
  const auto same = compare_paired(series, series, 0.95);
  EXPECT_EQ(same.p, 1.0);
  EXPECT_EQ(same.ratio, 1.0);
  EXPECT_EQ(same.low, 0.0);
  EXPECT_TRUE(std::isinf(same.high));
  EXPECT_THROW(compare_paired({}, {}, 0.95), std::invalid_argument);
  EXPECT_THROW(compare_paired(series, std::vector<double>{1, 2}, 0.95), std::invalid_argument);
  EXPECT_THROW(compare_paired(series, std::vector<double>{1, 2, std::nan("")}, 0.95), std::invalid_argument);
}

}  // namespace
}  // namespace touchstone::bench
