#include "change_points/change_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::change_points {
namespace {

using testing::ElementsAre;

std::vector<std::size_t> steps_of(const ChangeReport& report) {
  std::vector<std::size_t> found;
  for (const Change& change : report.changes) {
    if (change.kind == ChangeKind::step) found.push_back(change.index);
  }
  return found;
}

std::vector<double> noisy(std::size_t count, double noise, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> values(count);
  for (double& value : values) value = 1.0 + noise * random.normal();
  return values;
}

TEST(Changes, AStepIsFoundAtItsPlaceAtAnyScaleAndInBothDirections) {
  for (const double scale : {1e-6, 1.0, -1e6}) {
    for (const double to : {1.2, 0.8}) {
      auto values = noisy(60, 0.02, 5);
      for (std::size_t i = 40; i < values.size(); ++i) values[i] += to - 1.0;
      for (double& value : values) value *= scale;
      const auto report = find_changes(values, {.smallest_absolute = 0.0});
      ASSERT_THAT(steps_of(report), ElementsAre(40U)) << scale << ' ' << to;
      EXPECT_NEAR(report.changes[0].after / report.changes[0].before, to, 0.02);
      EXPECT_LE(report.changes[0].first, 40U);
      EXPECT_GE(report.changes[0].last, 40U);
    }
  }
}

TEST(Changes, AStepIsFoundThreeBuildsAfterIt) {
  auto values = noisy(63, 0.02, 11);
  for (std::size_t i = 60; i < values.size(); ++i) values[i] += 0.3;
  EXPECT_THAT(steps_of(find_changes(values)), ElementsAre(60U));
  values.pop_back();
  EXPECT_TRUE(find_changes(values).changes.empty()) << "two values may be outliers";
}

// At the rate of 1 % a year: in histories of fifty builds, a step as large as two deviations of the noise.
TEST(Changes, ASmallStepInAShortHistoryIsMostlyFound) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    auto values = noisy(50, 0.05, seed);
    for (std::size_t i = 25; i < values.size(); ++i) values[i] += 0.1;
    const auto steps = steps_of(find_changes(values, {.smallest_relative = 0.0}));
    found += steps.size() == 1 && steps[0] >= 23 && steps[0] <= 27 ? 1 : 0;
  }
  EXPECT_GE(found, 70);
}

TEST(Changes, AnOutlierBesideAStepDoesNotMoveIt) {
  auto values = noisy(60, 0.02, 17);
  for (std::size_t i = 30; i < values.size(); ++i) values[i] += 0.08;
  ASSERT_THAT(steps_of(find_changes(values)), ElementsAre(30U));
  values[27] += 0.2;
  EXPECT_THAT(steps_of(find_changes(values)), ElementsAre(30U));
}

TEST(Changes, OutliersAreNoSteps) {
  auto values = noisy(100, 0.02, 3);
  values[30] = values[31] = 5.0;
  values[80] = -3.0;
  EXPECT_TRUE(find_changes(values).changes.empty());
}

TEST(Changes, UpAndDownAgainAreTwo) {
  auto values = noisy(60, 0.002, 8);
  for (std::size_t i = 20; i < 30; ++i) values[i] += 0.02;
  EXPECT_THAT(steps_of(find_changes(values)), ElementsAre(20U, 30U));
}

TEST(Changes, ASmallStepASmallDriftAndAnotherLevelAreKeptApart) {
  auto values = noisy(120, 0.001, 21);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= i < 60 ? 1.0 : 1.04;
  const auto steps = find_changes(values);
  EXPECT_THAT(steps_of(steps), ElementsAre(60U));
  for (std::size_t i = 60; i < values.size(); ++i) values[i] += 0.0005 * static_cast<double>(i - 60);
  const auto both = find_changes(values);
  EXPECT_THAT(steps_of(both), ElementsAre(60U));
  ASSERT_EQ(both.changes.size(), 2U);
  EXPECT_EQ(both.changes[1].kind, ChangeKind::drift);
  EXPECT_NEAR(both.changes[1].after - both.changes[1].before, 0.0005 * 59, 0.002);
}

TEST(Changes, ADriftIsNoStaircase) {
  auto values = noisy(100, 0.01, 4);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.003 * static_cast<double>(i);
  const auto report = find_changes(values);
  ASSERT_EQ(report.changes.size(), 1U);
  EXPECT_EQ(report.changes[0].kind, ChangeKind::drift);
  EXPECT_NEAR(report.changes[0].after, 1.3, 0.01);
  // A step inside it keeps its place.
  for (std::size_t i = 50; i < values.size(); ++i) values[i] += 0.1;
  EXPECT_THAT(steps_of(find_changes(values)), ElementsAre(50U));
}

// Three rises of two deviations each: a line explains them better than any one step, and three steps better than a
// line. (multiple_changes() of github.com/jdrumgoole/otava-test-data, revision 32d2971, is of this form.)
TEST(Changes, AStaircaseIsNoDrift) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto values = noisy(500, 0.05, seed);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.1 * static_cast<double>(i / 125);
    const ChangeReport report = find_changes(values);
    ASSERT_EQ(report.changes.size(), 3U) << seed;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(report.changes[i].kind, ChangeKind::step) << seed;
      EXPECT_NEAR(static_cast<double>(report.changes[i].index), 125.0 * static_cast<double>(i + 1), 10.0) << seed;
    }
  }
}

// In fifty builds no step of it would pass alone, and a line is within a deviation of all of them.
TEST(Changes, AShortStaircaseIsOftenNoDriftAndASlopeIsMostlyNoStaircase) {
  int stairs = 0;
  int staircases_of_lines = 0;
  int steps_of_lines = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto noise = noisy(50, 0.05, seed);
    auto values = noise;
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] += 0.1 * static_cast<double>(std::min<std::size_t>(i / 12, 3));
    for (const std::size_t step : steps_of(find_changes(values))) stairs += (step + 2) % 12 <= 4 ? 1 : 0;
    values = noise;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.3 * static_cast<double>(i) / 49.0;
    const std::size_t steps = steps_of(find_changes(values)).size();
    staircases_of_lines += steps > 1 ? 1 : 0;
    steps_of_lines += steps == 1 ? 1 : 0;
  }
  EXPECT_GE(stairs, 120) << "of 300";
  EXPECT_LE(staircases_of_lines, 10);
  EXPECT_LE(steps_of_lines, 3);
}

TEST(Changes, AnExactSeriesChangesAtOnce) {
  std::vector<double> values(20, 0.25);
  values.push_back(0.2501);
  EXPECT_TRUE(find_changes(values).exact);
  EXPECT_THAT(steps_of(find_changes(values)), ElementsAre(20U));
  values.back() = 0.25 + 1e-14;
  EXPECT_TRUE(find_changes(values).changes.empty()) << "rounding";
  EXPECT_TRUE(find_changes(values, {.smallest_relative = 0.1}).changes.empty());
}

TEST(Changes, RoundingAfterZerosIsNoChange) {
  std::vector<double> values(20, 0.0);
  values.push_back(1e-15);
  EXPECT_TRUE(find_changes(values).changes.empty());
  values.back() = 1e-3;
  EXPECT_THAT(steps_of(find_changes(values)), ElementsAre(20U));
}

TEST(Changes, ShortSeriesHaveNone) {
  EXPECT_TRUE(find_changes({}).changes.empty());
  EXPECT_TRUE(find_changes(std::vector<double>{1.0, 2.0}).changes.empty());
}

TEST(Changes, LevelsCoverTheSeries) {
  auto values = noisy(60, 0.002, 8);
  for (std::size_t i = 20; i < 30; ++i) values[i] += 0.02;
  const auto report = find_changes(values);
  ASSERT_EQ(report.levels.size(), 3U);
  EXPECT_EQ(report.levels[0].first, 0U);
  EXPECT_EQ(report.levels[1].first, report.levels[0].end);
  EXPECT_EQ(report.levels[2].end, 60U);
}

}  // namespace
}  // namespace touchstone::change_points
