#include "harness/report/console.h"

#include "harness/base/error.h"
#include "harness/report/sample_result_for_test.h"

namespace touchstone::report {
using metrics::MetricSet;

namespace {

TEST(Console, EveryMetricWithItsUnitInColumnsThatLineUp) {
  const EvaluationResult one = sample_result("one");
  const EvaluationResult two = sample_result("two");
  const std::string table = console_table({{"one", &one.metrics}, {"two", &two.metrics}});
  for (const metrics::MetricResult& metric : one.metrics)
    EXPECT_NE(table.find("\n" + metric.name + " "), std::string::npos) << metric.name;
  std::istringstream lines(table);
  std::string line;
  std::getline(lines, line);
  const std::size_t width = line.size();
  EXPECT_TRUE(line.ends_with("two"));
  while (std::getline(lines, line)) EXPECT_EQ(line.size(), width) << line;
}

TEST(Console, MissingAndInvalidAreWordsNotNumbers) {
  MetricSet set({"force-error"}, {}, {});
  const auto metrics = set.results();
  const std::string table = console_table({{"empty", &metrics}});
  EXPECT_NE(table.find("missing"), std::string::npos);
  EXPECT_EQ(table.find_first_of("0123456789"), std::string::npos) << table;
}

TEST(Console, DifferentMetricsAreNoTable) {
  const auto a = MetricSet({"force-error"}, {}, {}).results();
  const auto b = MetricSet({"step-cost"}, {}, {}).results();
  EXPECT_THROW(console_table({{"a", &a}, {"b", &b}}), UsageError);
}

}  // namespace
}  // namespace touchstone::report
