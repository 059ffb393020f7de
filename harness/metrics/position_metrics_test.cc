#include <cmath>
#include <limits>

#include "harness/metrics/catalogue.h"
#include "harness/metrics/episodes.h"
#include "harness/metrics/position_error.h"
#include "harness/metrics/step_cost.h"

namespace touchstone::metrics {
namespace {

MetricSample at(double t_s, const Vec3& out, const Vec3& contact) {
  MetricSample sample;
  sample.t_s = t_s;
  sample.out_W_m = out;
  sample.contact_W_m = contact;
  return sample;
}

TEST(PositionError, ExactOnAThreeFourFiveTriangle) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    PositionError metric;
    metric.add(at(0.0, scale * Vec3(1, 1, 1), scale * Vec3(4, 5, 1)));
    metric.add(at(0.5, scale * Vec3(1, 1, 1), scale * Vec3(1, 1, 1)));
    const auto results = metric.results();
    EXPECT_NEAR(find_result(results, "rms_position_error").value, scale * std::sqrt(12.5), 1e-14 * scale);
    EXPECT_NEAR(find_result(results, "mean_position_error").value, scale * 2.5, 1e-14 * scale);
    EXPECT_NEAR(find_result(results, "max_position_error").value, scale * 5.0, 1e-14 * scale);
    EXPECT_EQ(find_result(results, "max_position_error").t_s, 0.0);
  }
}

TEST(Episodes, WhereWhenHowLongHowBad) {
  EpisodeFinder finder(1.0);
  const std::vector<double> errors{0.5, 2.0, 3.0, 1.0, 0.0, 4.0, 1.5};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    finder.add(0.1 * static_cast<double>(i), errors[i], Vec3(static_cast<double>(i), 0, 0));
  }
  EXPECT_EQ(finder.count(), 2u);
  const auto worst = finder.worst();
  ASSERT_EQ(worst.size(), 2u);
  // The last one is open where the recording ends.
  EXPECT_EQ(worst[0].worst, 4.0);
  EXPECT_DOUBLE_EQ(worst[0].start_s, 0.5);
  EXPECT_DOUBLE_EQ(worst[0].end_s, 0.6);
  EXPECT_EQ(worst[0].samples, 2u);
  EXPECT_EQ(worst[1].worst, 3.0);
  EXPECT_DOUBLE_EQ(worst[1].start_s, 0.1);
  EXPECT_DOUBLE_EQ(worst[1].end_s, 0.3);  // exactly at the threshold is not over it
  EXPECT_DOUBLE_EQ(worst[1].worst_t_s, 0.2);
  EXPECT_EQ(worst[1].worst_W_m, Vec3(2, 0, 0));
  EXPECT_NEAR(finder.total_s(), 0.3, 1e-15);
}

TEST(Episodes, KeepsTheWorstOfManyAndCountsAll) {
  EpisodeFinder finder(1.0);
  const int episodes = 1000;
  for (int i = 0; i < episodes; ++i) {
    finder.add(2.0 * i, 2.0 + (i * 617) % episodes, Vec3::Zero());
    finder.add(2.0 * i + 1.0, 0.0, Vec3::Zero());
  }
  EXPECT_EQ(finder.count(), 1000u);
  EXPECT_DOUBLE_EQ(finder.total_s(), 1000.0);
  const auto worst = finder.worst();
  ASSERT_EQ(worst.size(), EpisodeFinder::kept);
  for (std::size_t i = 0; i < worst.size(); ++i) EXPECT_EQ(worst[i].worst, 2.0 + 999.0 - static_cast<double>(i));
}

TEST(Episodes, NotANumberIsNeverAPass) {
  ErrorEpisodes metric(ErrorEpisodes::Of::position, {});
  metric.add(at(0.0, Vec3::Zero(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN())));
  for (const MetricResult& result : metric.results()) {
    EXPECT_EQ(result.status, MetricStatus::invalid);
    EXPECT_TRUE(std::isnan(result.value));
  }
}

TEST(StepCost, MeanMedianP99Max) {
  StepCost metric;
  MetricSample sample;
  for (int i = 1; i <= 1001; ++i) {
    sample.t_s = i;
    sample.cost_us = i == 700 ? 5000.0 : 2.0;
    metric.add(sample);
  }
  const auto results = metric.results();
  EXPECT_DOUBLE_EQ(find_result(results, "mean_step_cost").value, (1000.0 * 2.0 + 5000.0) / 1001.0);
  EXPECT_NEAR(find_result(results, "median_step_cost").value, 2.0, 2.0 * Quantiles::relative_error * (1 + 1e-9));
  EXPECT_NEAR(find_result(results, "p99_step_cost").value, 2.0, 2.0 * Quantiles::relative_error * (1 + 1e-9));
  EXPECT_EQ(find_result(results, "max_step_cost").value, 5000.0);
  EXPECT_EQ(find_result(results, "max_step_cost").t_s, 700.0);
}

}  // namespace
}  // namespace touchstone::metrics
