#include "harness/metrics/time_ranges.h"

#include "harness/base/error.h"
#include "harness/testing/steps.h"

namespace touchstone::metrics {
namespace {

TEST(TimeRanges, HalfOpenRanges) {
  const TimeRanges ranges = TimeRanges::parse("0:6,12:18", "--fit-range");
  EXPECT_TRUE(ranges.contains(0.0, 0.0));
  EXPECT_TRUE(ranges.contains(5.999, 0.0));
  EXPECT_FALSE(ranges.contains(6.0, 0.0));
  EXPECT_TRUE(ranges.contains(12.0, 0.0));
  EXPECT_FALSE(ranges.contains(18.0, 0.0));
  EXPECT_FALSE(ranges.contains(-1.0, 0.0));
}

TEST(TimeRanges, AlternatingBlocksCountFromTheFirstSampleAndNeverOverlap) {
  const TimeRanges even = TimeRanges::parse("even:6s", "--fit-range");
  const TimeRanges odd = TimeRanges::parse("odd:6", "--score-range");
  const double first = 100.5;
  EXPECT_TRUE(even.contains(100.5, first));
  EXPECT_FALSE(even.contains(106.5, first));
  EXPECT_TRUE(even.contains(112.5, first));
  for (const double t : testing::steps(first, first + 60.0, 0.37))
    EXPECT_NE(even.contains(t, first), odd.contains(t, first)) << t;
}

TEST(TimeRanges, EverythingWhereNothingIsSaid) {
  EXPECT_TRUE(TimeRanges{}.contains(-1e9, 0.0));
  EXPECT_TRUE(TimeRanges::parse("all", "--time-range").everything());
}

TEST(TimeRanges, NonsenseIsRefusedWithTheOptionNamed) {
  for (const char* text :
       {"", "6", "6:0", "3:3", "0:6,", "a:b", "0:nan", "0:inf", "even:0", "even:-2s", "odd:", "0;6"}) {
    try {
      (void)TimeRanges::parse(text, "--fit-range");
      ADD_FAILURE() << text;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("--fit-range"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace touchstone::metrics
