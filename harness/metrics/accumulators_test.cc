#include <cmath>
#include <limits>

#include "harness/base/random.h"
#include "harness/metrics/histogram.h"
#include "harness/metrics/moments.h"
#include "harness/metrics/quantiles.h"
#include "harness/metrics/series.h"

namespace touchstone::metrics {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Moments, ExactOnSmallIntegers) {
  Moments moments;
  for (const double v : {3.0, -4.0, 0.0, 5.0}) moments.add(10.0 + v, v);
  EXPECT_EQ(moments.mean(), 1.0);
  EXPECT_EQ(moments.rms(), std::sqrt(12.5));
  EXPECT_EQ(moments.peak(), 5.0);
  EXPECT_EQ(moments.peak_t_s(), 15.0);
}

TEST(Moments, CompensationKeepsWhatPlainSumsLose) {
  Moments moments;
  moments.add(0.0, 1e16);
  for (int i = 0; i < 1000; ++i) moments.add(1.0, 1.0);
  moments.add(2.0, -1e16);
  EXPECT_EQ(moments.mean() * 1002.0, 1000.0);
}

TEST(Moments, OneBadSampleLeavesNoNumber) {
  for (const double bad : {nan, std::numeric_limits<double>::infinity()}) {
    Moments moments;
    moments.add(0.0, 1.0);
    moments.add(1.0, bad);
    moments.add(2.0, 1.0);
    EXPECT_TRUE(std::isnan(moments.mean()));
    EXPECT_TRUE(std::isnan(moments.rms()));
    EXPECT_TRUE(std::isnan(moments.peak()));
    EXPECT_EQ(moments.bad(), 1u);
    EXPECT_EQ(moments.first_bad_t_s(), 1.0);
  }
  EXPECT_TRUE(std::isnan(Moments{}.mean()));
}

TEST(Series, KeepsEverySampleUpToTheLimit) {
  SeriesRecorder recorder("x", "N", 8);
  for (int i = 0; i < 8; ++i) recorder.add(i, i * i);
  const Series series = recorder.series();
  ASSERT_EQ(series.value.size(), 8u);
  EXPECT_EQ(series.samples_per_pair, 1u);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(series.value[static_cast<std::size_t>(i)], i * i);
}

TEST(Series, KeepsEveryPeakAtAnyLength) {
  for (const int samples : {9, 100, 1023, 40'000}) {
    for (const int peak : {0, 1, samples / 3, samples - 1}) {
      SeriesRecorder recorder("x", "N", 16);
      for (int i = 0; i < samples; ++i) recorder.add(0.001 * i, i == peak ? 7.0 : 0.001 * (i % 5));
      const Series series = recorder.series();
      EXPECT_LE(series.value.size(), 16u);
      EXPECT_EQ(series.samples, static_cast<std::uint64_t>(samples));
      const auto top = std::max_element(series.value.begin(), series.value.end());
      EXPECT_EQ(*top, 7.0) << samples << ' ' << peak;
      EXPECT_EQ(series.t_s[static_cast<std::size_t>(top - series.value.begin())], 0.001 * peak);
      EXPECT_TRUE(std::is_sorted(series.t_s.begin(), series.t_s.end()));
    }
  }
}

TEST(Series, NotANumberIsAGapNotAValue) {
  SeriesRecorder recorder("x", "N", 4);
  recorder.add(0.0, 1.0);
  recorder.add(1.0, nan);
  recorder.add(2.0, std::numeric_limits<double>::infinity());
  const Series series = recorder.series();
  EXPECT_EQ(series.value[0], 1.0);
  EXPECT_TRUE(std::isnan(series.value[1]));
  EXPECT_TRUE(std::isnan(series.value[2]));
}

TEST(Histogram, CountsAreExactWhateverTheRange) {
  Random random(7);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    HistogramRecorder recorder("N");
    std::vector<double> values{0.0, 0.0};
    for (int i = 0; i < 5000; ++i) values.push_back(scale * random.log_uniform(1e-4, 1e2));
    for (const double v : values) recorder.add(v);
    const Histogram histogram = recorder.histogram();
    ASSERT_LE(histogram.counts.size(), HistogramRecorder::bins);
    ASSERT_EQ(histogram.total(), values.size());
    for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
      const auto inside = std::count_if(values.begin(), values.end(), [&](double v) {
        return std::floor(v / histogram.width) == static_cast<double>(bin);
      });
      EXPECT_EQ(histogram.counts[bin], static_cast<std::uint64_t>(inside));
    }
    // The range is used: the largest value is in the upper half of the bins.
    EXPECT_GT(histogram.counts.size(), HistogramRecorder::bins / 2);
  }
}

TEST(Histogram, OnlyZerosHaveNoWidth) {
  HistogramRecorder recorder("N");
  recorder.add(0.0);
  recorder.add(nan);
  EXPECT_EQ(recorder.histogram().width, 0.0);
  EXPECT_EQ(recorder.histogram().total(), 1u);
}

TEST(Quantiles, WithinTheStatedErrorOfTheSortedTwin) {
  Random random(11);
  Quantiles sketch;
  std::vector<double> values(4, 0.0);
  for (int i = 0; i < 20'000; ++i) values.push_back(random.log_uniform(1e-3, 1e5));
  for (const double v : values) sketch.add(v);
  std::sort(values.begin(), values.end());
  for (const double q : {0.0, 0.001, 0.25, 0.5, 0.9, 0.99, 1.0}) {
    const double exact = values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
    // A hair above the bound for the rounding of log and pow.
    EXPECT_NEAR(sketch.quantile(q), exact, exact * Quantiles::relative_error * (1.0 + 1e-9)) << q;
  }
  EXPECT_TRUE(std::isnan(Quantiles{}.quantile(0.5)));
}

}  // namespace
}  // namespace touchstone::metrics
