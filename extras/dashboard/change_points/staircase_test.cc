#include "change_points/staircase.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::change_points {
namespace {

using testing::IsEmpty;
using testing::IsSupersetOf;

std::vector<std::size_t> staircase(const std::vector<double>& values) {
  return find_staircase(values, find_trend(values));
}

std::vector<double> with_noise(std::size_t count, Random& random, const std::function<double(std::size_t)>& level) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = level(i) + random.normal();
  return values;
}

// Noise adds a tread now and then.
TEST(Staircase, LargeStepsStandAtTheirPlaces) {
  Random random(31);
  int exact = 0;
  for (int run = 0; run < 40; ++run) {
    const auto values = with_noise(60, random, [](std::size_t i) { return 8.0 * static_cast<double>(i / 20); });
    const auto steps = staircase(values);
    EXPECT_THAT(steps, IsSupersetOf({20U, 40U})) << run;
    exact += steps.size() == 2 ? 1 : 0;
  }
  EXPECT_GE(exact, 32);
}

TEST(Staircase, AnOutlierIsNoTread) {
  Random random(32);
  auto values = with_noise(60, random, [](std::size_t i) { return 0.2 * static_cast<double>(i); });
  values[30] += 60.0;
  EXPECT_THAT(staircase(values), IsEmpty());
}

TEST(Staircase, TooFewValuesAreNone) {
  EXPECT_THAT(staircase({}), IsEmpty());
  EXPECT_THAT(staircase({1, 1, 2, 2, 3, 3, 4, 4}), IsEmpty());
}

// The limit of the header: lines of every rise, in short and in long stretches.
TEST(Staircase, OneStraightLineInTwentyPasses) {
  constexpr int runs = 200;
  int passed = 0;
  int all = 0;
  Random random(33);
  for (const std::size_t count : {25U, 50U, 100U, 200U}) {
    for (const double rise : {4.0, 8.0}) {
      int of_these = 0;
      for (int run = 0; run < runs; ++run) {
        const auto values = with_noise(count, random, [&](std::size_t i) {
          return rise * static_cast<double>(i) / static_cast<double>(count - 1);
        });
        of_these += staircase(values).empty() ? 0 : 1;
      }
      EXPECT_LE(of_these, runs / 8) << count << ' ' << rise;
      passed += of_these;
      all += runs;
    }
  }
  EXPECT_LE(passed, all * 6 / 100);
}

}  // namespace
}  // namespace touchstone::change_points
