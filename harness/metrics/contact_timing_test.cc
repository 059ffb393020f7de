#include "harness/metrics/contact_timing.h"

#include "harness/metrics/catalogue.h"

namespace touchstone::metrics {
namespace {

MetricOptions options() {
  MetricOptions out;
  out.force_floor_N = 1.0;
  out.match_window_s = 0.3;
  return out;
}

MetricSample forces(double t_s, double measured_N, double rendered_N) {
  MetricSample sample;
  sample.t_s = t_s;
  sample.f_measured_W_N = Vec3(0, 0, measured_N);
  sample.f_rendered_W_N = Vec3(rendered_N, 0, 0);
  return sample;
}

TEST(ContactDetector, InterpolatesWithHysteresis) {
  ContactDetector detector(1.0);
  EXPECT_FALSE(detector.add(0.0, 0.0));
  const auto onset = detector.add(1.0, 4.0);  // through 1 N a quarter of the way
  ASSERT_TRUE(onset);
  EXPECT_TRUE(onset->onset);
  EXPECT_DOUBLE_EQ(onset->t_s, 0.25);
  EXPECT_FALSE(detector.add(2.0, 0.75));  // below the floor, above half of it: still in contact
  EXPECT_FALSE(detector.add(3.0, 1.5));
  const auto release = detector.add(4.0, 0.0);  // through 0.5 N two thirds of the way
  ASSERT_TRUE(release);
  EXPECT_FALSE(release->onset);
  EXPECT_DOUBLE_EQ(release->t_s, 3.0 + 2.0 / 3.0);
}

TEST(ContactDetector, ContactAtTheFirstSampleHasNoOnset) {
  ContactDetector detector(1.0);
  EXPECT_FALSE(detector.add(0.0, 5.0));
  EXPECT_FALSE(detector.add(1.0, 5.0));
  EXPECT_TRUE(detector.add(2.0, 0.0));
}

TEST(EventMatcher, MissedSpuriousAndShifted) {
  EventMatcher matcher(0.3);
  matcher.measured(1.0);
  matcher.rendered(1.1);  // 0.1 late
  matcher.rendered(2.0);  // nothing measured
  matcher.measured(3.0);  // nothing rendered
  matcher.rendered(4.8);
  matcher.measured(5.0);  // 0.2 early
  matcher.advance(6.0);
  matcher.measured(6.5);  // open at the end
  matcher.finish();
  EXPECT_EQ(matcher.events(), 4u);
  EXPECT_EQ(matcher.missed(), 2u);
  EXPECT_EQ(matcher.spurious(), 1u);
  EXPECT_EQ(matcher.shift().count(), 2u);
  EXPECT_NEAR(matcher.shift().mean(), -0.05, 1e-15);
  EXPECT_NEAR(matcher.shift().peak(), -0.2, 1e-15);
}

TEST(ContactTiming, AConstantDelayIsFoundExactly) {
  const double delay = 0.06;
  // Trapezoids of 1 s at 2, 5 and 8 s with flanks of 0.1 s: linear, so interpolation is exact.
  const auto force = [](double t) {
    double sum = 0.0;
    for (const double at : {2.0, 5.0, 8.0}) {
      sum += 4.0 * std::clamp((t - at) / 0.1, 0.0, 1.0) * std::clamp((at + 1.0 - t) / 0.1, 0.0, 1.0);
    }
    return sum;
  };
  ContactTiming metric(options());
  for (int i = 0; i <= 1000; ++i) metric.add(forces(0.01 * i, force(0.01 * i), force(0.01 * i - delay)));
  const auto results = metric.results();
  EXPECT_EQ(find_result(results, "onsets").value, 3.0);
  EXPECT_EQ(find_result(results, "missed_onsets").value, 0.0);
  EXPECT_EQ(find_result(results, "spurious_releases").value, 0.0);
  EXPECT_NEAR(find_result(results, "mean_onset_shift").value, delay, 1e-12);
  EXPECT_NEAR(find_result(results, "max_release_shift").value, delay, 1e-12);
}

TEST(ContactTiming, ARendererThatNeverAnswersMissesEverything) {
  ContactTiming metric(options());
  for (int i = 0; i <= 100; ++i) metric.add(forces(0.1 * i, (i / 10) % 2 == 1 ? 3.0 : 0.0, 0.0));
  const auto results = metric.results();
  EXPECT_EQ(find_result(results, "onsets").value, 5.0);
  EXPECT_EQ(find_result(results, "missed_onsets").value, 5.0);
  EXPECT_EQ(find_result(results, "mean_onset_shift").status, MetricStatus::missing);
}

TEST(ContactTiming, NotANumberMakesEveryAnswerInvalid) {
  ContactTiming metric(options());
  metric.add(forces(0.0, 0.0, 0.0));
  metric.add(forces(1.0, 0.0, std::numeric_limits<double>::quiet_NaN()));
  for (const MetricResult& result : metric.results()) EXPECT_EQ(result.status, MetricStatus::invalid) << result.name;
}

}  // namespace
}  // namespace touchstone::metrics
