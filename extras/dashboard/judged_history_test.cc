#include "judged_history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::dashboard {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

HistorySeries series_of(const std::string& metric, const std::vector<double>& values) {
  HistorySeries series{{"site", "build", "Nightly", "test", metric}, {}};
  for (std::size_t i = 0; i < values.size(); ++i) series.points.push_back({"c" + std::to_string(i), "", values[i]});
  return series;
}

HistoryLimits at_most(double maximum) {
  HistoryLimits limits;
  HistoryLimit limit;
  limit.maximum = maximum;
  limits.limits = {limit};
  return limits;
}

TEST(JudgedHistory, TheSeriesThatFailedIsTheWorstThoughAnotherIsLonger) {
  const JudgedHistory history =
      judge_history({series_of("long", {1, 1, 1, 1, 1, 1}), series_of("broken", {1, 1, 9})}, at_most(5.0));
  ASSERT_NE(history.worst(), nullptr);
  EXPECT_EQ(history.worst()->series.key.metric, "broken");
  EXPECT_TRUE(history.failed());
  EXPECT_EQ(history.failures(), 1U);
  EXPECT_THAT(history.text(), StartsWith("1 of 2 series failed."));
  EXPECT_THAT(history.text(), HasSubstr("broken of test, site/build, Nightly"));
  EXPECT_THAT(history.text(), Not(HasSubstr("long of test"))) << "it has nothing to say";
}

TEST(JudgedHistory, OneSeriesIsPrintedWithItsValues) {
  const JudgedHistory history = judge_history({series_of("one", {1.25, 1.25})}, at_most(5.0));
  EXPECT_FALSE(history.failed());
  EXPECT_THAT(history.text(), StartsWith("No limit is broken and nothing has become worse in 1 series."));
  EXPECT_THAT(history.text(), HasSubstr("c1"));
  EXPECT_THAT(history.text(), HasSubstr("1.25"));
  EXPECT_THAT(history.text(), HasSubstr("values: 2; steps: 0; drifts: 0: passed"));
  EXPECT_THAT(history.text(), HasSubstr("1 series; false alarms"));
}

TEST(JudgedHistory, ALimitThatSeesNothingFails) {
  const JudgedHistory history = judge_history({series_of("gone", {})}, at_most(5.0));
  EXPECT_TRUE(history.failed());
  EXPECT_THAT(history.text(), HasSubstr("there is no value to judge"));
  EXPECT_EQ(judge_history({}, at_most(5.0)).worst(), nullptr);
}

}  // namespace
}  // namespace touchstone::dashboard
