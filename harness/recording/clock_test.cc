#include "harness/recording/clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::recording {
namespace {

TEST(Clock, ASteadyClockIsExactAtAnyRateAndOrigin) {
  for (const double rate_Hz : {0.01, 60.0, 1000.0, 5000.0, 1e6}) {
    for (const double start_s : {0.0, -7.0, 100.0}) {
      std::vector<double> t_s;
      for (int i = 0; i < 5000; ++i) t_s.push_back(start_s + i / rate_Hz);
      const ClockReport report = examine_clock(t_s);
      // The times themselves are rounded: each interval is right to an ulp of the largest time.
      const double ulp = 2.3e-16 * std::max(std::abs(t_s.front()), std::abs(t_s.back()));
      EXPECT_NEAR(report.median_interval_s, 1.0 / rate_Hz, ulp);
      EXPECT_NEAR(report.mean_rate_Hz, rate_Hz, rate_Hz * rate_Hz * ulp);
      EXPECT_LE(report.jitter_rms_s, 2.0 * ulp);
      EXPECT_EQ(report.gap_count, 0U);
      EXPECT_EQ(report.samples, 5000U);
    }
  }
}

TEST(Clock, JitterAgreesWithTheExactStatistics) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    Random random(11);
    std::vector<double> t_s{0.0};
    std::vector<double> intervals;
    for (int i = 0; i < 20001; ++i) {
      t_s.push_back(t_s.back() + scale * 0.015 * (1.0 + 0.05 * random.normal()));
      intervals.push_back(t_s.back() - *(t_s.end() - 2));
    }
    std::ranges::sort(intervals);
    const double median = intervals[intervals.size() / 2];
    double squares = 0.0;
    for (const double d : intervals) squares += (d - median) * (d - median);
    const ClockReport report = examine_clock(t_s);
    EXPECT_NEAR(report.median_interval_s, median, 1.4e-3 * median) << "one bin";
    EXPECT_NEAR(report.jitter_rms_s, std::sqrt(squares / static_cast<double>(intervals.size())), 1e-3 * scale * 0.015);
    EXPECT_EQ(report.shortest_s, intervals.front());
    EXPECT_EQ(report.longest_s, intervals.back());
  }
}

TEST(Clock, GapsAreFoundWhereTheyAreAndLeftOutOfTheJitter) {
  std::vector<double> t_s;
  double t = 0.0;
  for (int i = 0; i < 1000; ++i) {
    t_s.push_back(t);
    t += i == 99 ? 1.0 : i == 500 ? 0.5 : i == 700 ? 0.0625 : 0.015625;
  }
  const ClockReport report = examine_clock(t_s);
  ASSERT_EQ(report.gap_count, 2U) << "4 median intervals are no gap";
  EXPECT_EQ(report.gaps[0].after_sample, 99U);
  EXPECT_EQ(report.gaps[0].from_s, t_s[99]);
  EXPECT_EQ(report.gaps[0].length_s, 1.0);
  EXPECT_EQ(report.gaps[1].after_sample, 500U);
  EXPECT_EQ(report.median_interval_s, 0.015625);
  EXPECT_DOUBLE_EQ(report.jitter_rms_s, (0.0625 - 0.015625) / std::sqrt(997.0));
  EXPECT_THAT(report.summary(), ::testing::HasSubstr("2 gaps"));
}

TEST(Clock, MoreGapsThanAreListedAreStillCounted) {
  std::vector<double> t_s{0.0};
  for (int i = 0; i < 3000; ++i) {
    t_s.push_back(t_s.back() + 1.0);
    t_s.push_back(t_s.back() + 1.0);
    t_s.push_back(t_s.back() + 64.0 + i);
  }
  const ClockReport report = examine_clock(t_s);
  EXPECT_EQ(report.gap_count, 3000U);
  EXPECT_EQ(report.gaps.size(), 1024U);
  EXPECT_EQ(report.gaps.front().length_s, 64.0 + 3000 - 1024) << "the longest are kept";
}

TEST(Clock, RefusesTimesThatDoNotIncrease) {
  EXPECT_THROW(examine_clock({0.0, 1.0, 1.0}), BadData);
  EXPECT_THROW(examine_clock({0.0, std::nan("")}), BadData);
  EXPECT_EQ(examine_clock({}).samples, 0U);
  EXPECT_EQ(examine_clock({3.0}).median_interval_s, 0.0);
  EXPECT_EQ(parse_on_gap("split"), OnGap::split);
  EXPECT_EQ(parse_on_duplicate("mean"), OnDuplicate::mean);
  EXPECT_THROW(parse_on_gap("first"), UsageError);
  EXPECT_THROW(parse_on_duplicate(""), UsageError);
}

}  // namespace
}  // namespace touchstone::recording
