#include "harness/perception/perceptual_metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/metrics/catalogue.h"

namespace touchstone::perception {
using metrics::MetricStatus;
using recording::Recording;

namespace {

Recording presses(double k, const Vec3& n) {
  Recording recording;
  recording.source = "presses.csv";
  for (int i = 0; i < 4000; ++i) {
    const double depth = 0.005 * (1.0 - std::cos(2.0 * std::numbers::pi * 0.001 * i)) - 0.001;
    recording.motion.t_s.push_back(0.001 * i);
    recording.motion.p_W_m.push_back(-depth * n);
    recording.f_W_N.push_back(k * std::max(depth, 0.0) * n);
  }
  return recording;
}

TEST(NoticeableForceError, CountsInJustNoticeableDifferences) {
  NoticeableForceError metric;
  metrics::MetricSample sample;
  for (int i = 0; i < 10; ++i) {
    sample.t_s = i;
    sample.f_measured_W_N = {0.0, 0.0, 1.0};
    // 0.2 N is one JND at 1 N: across the force it errs as much as along it.
    sample.f_rendered_W_N = i < 5 ? Vec3(0.0, 0.0, 1.0) : (i < 8 ? Vec3(0.0, 0.0, 1.1) : Vec3(0.4, 0.0, 1.0));
    metric.add(sample);
  }
  const auto results = metric.results();
  EXPECT_NEAR(find_result(results, "rms_force_error_jnd").value, std::sqrt((3 * 0.25 + 2 * 4.0) / 10.0), 1e-12);
  EXPECT_NEAR(find_result(results, "max_force_error_jnd").value, 2.0, 1e-12);
  EXPECT_EQ(find_result(results, "max_force_error_jnd").t_s.value(), 8.0);
  EXPECT_DOUBLE_EQ(find_result(results, "noticeable_share").value, 0.2);
  sample.f_rendered_W_N.x() = std::nan("");
  metric.add(sample);
  for (const auto& result : metric.results()) EXPECT_EQ(result.status, MetricStatus::invalid) << result.name;
  NoticeableForceError silent;
  for (const auto& result : silent.results()) EXPECT_NE(result.status, MetricStatus::ok);
}

TEST(NoticeableForceError, SaysWhatAPersonWouldNoticeItBy) {
  const auto noticed_as = [](const Vec3& error) {
    NoticeableForceError metric;
    for (int i = 0; i < 1000; ++i) {
      metrics::MetricSample sample;
      sample.t_s = 0.001 * i;
      sample.out_W_m = {1e-5 * i, 0.0, 0.0};  // slides along x at 10 mm/s
      sample.f_measured_W_N = {0.0, 0.0, 1.0};
      sample.f_rendered_W_N = sample.f_measured_W_N + (i < 630 ? Vec3(Vec3::Zero()) : error);
      metric.add(sample);
    }
    const auto results = metric.results();
    return find_result(results, "noticeable_share").note;
  };
  EXPECT_THAT(noticed_as({-0.5, 0.0, 0.1}), ::testing::HasSubstr("in 37 % of the scan, mostly as friction"));
  EXPECT_THAT(noticed_as({0.0, 0.0, 0.5}), ::testing::HasSubstr("mostly as the strength of the force"));
  EXPECT_THAT(noticed_as({0.0, 0.5, 0.0}), ::testing::HasSubstr("mostly as the direction of the force"));
}

TEST(PressMetrics, TellHardnessBesideTheMeasuredOne) {
  for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0.6, 0.0, 0.8)}) {
    const Recording measured = presses(500.0, n);
    auto rendered = presses(400.0, n).f_W_N;
    const auto results = press_metrics(measured, rendered);
    ASSERT_EQ(results.size(), 4u);
    EXPECT_NEAR(find_result(results, "rate_hardness").value, 400.0, 1.0);
    EXPECT_NEAR(find_result(results, "rate_hardness").reference.value(), 500.0, 1.0);
    EXPECT_NEAR(find_result(results, "rate_hardness_error").value, 0.2, 0.01);
    const auto& extended = find_result(results, "extended_rate_hardness");
    EXPECT_NEAR(extended.value / extended.reference.value(), 0.8, 0.1);
    EXPECT_LT(find_result(results, "force_structural_similarity").value, 1.0);
    EXPECT_DOUBLE_EQ(find_result(press_metrics(measured, measured.f_W_N), "force_structural_similarity").value, 1.0);
  }
}

// A press of a tenth of the time: what happens in free air is not part of the hardness.
TEST(PressMetrics, DoNotCountFreeAir) {
  Recording measured = presses(500.0, Vec3::UnitZ());
  auto rendered = presses(400.0, Vec3::UnitZ()).f_W_N;
  const std::size_t n = measured.size();
  const double step_s = measured.motion.t_s[1] - measured.motion.t_s[0];
  for (std::size_t i = 0; i < 9 * n; ++i) {
    measured.motion.t_s.push_back(measured.motion.t_s.back() + step_s);
    measured.motion.p_W_m.emplace_back(0, 0, 0.02 + 0.01 * std::sin(0.02 * static_cast<double>(i)));
    measured.f_W_N.push_back(Vec3::Zero());
    rendered.push_back(Vec3::Zero());
  }
  const auto results = press_metrics(measured, rendered);
  EXPECT_NEAR(find_result(results, "rate_hardness").value, 400.0, 1.0);
  EXPECT_NEAR(find_result(results, "rate_hardness").reference.value(), 500.0, 1.0);
}

TEST(PressMetrics, OfStrokesAreMissing) {
  Recording stroke = presses(500.0, Vec3::UnitZ());
  for (std::size_t i = 0; i < stroke.size(); ++i)
    stroke.motion.p_W_m[i].z() = -1e-3 * std::sin(0.37 * static_cast<double>(i));
  const auto results = press_metrics(stroke, stroke.f_W_N);
  for (const char* const name : {"rate_hardness", "rate_hardness_error"}) {
    EXPECT_EQ(find_result(results, name).status, MetricStatus::missing) << name;
    EXPECT_THAT(find_result(results, name).note, ::testing::HasSubstr("does not follow the displacement"));
  }
}

TEST(PressMetrics, AreMissingWithAReason) {
  Recording still = presses(500.0, Vec3::UnitZ());
  for (Vec3& p : still.motion.p_W_m) p = Vec3(0, 0, -0.001);
  const auto without_motion = press_metrics(still, still.f_W_N);
  EXPECT_EQ(find_result(without_motion, "rate_hardness").status, MetricStatus::missing);
  EXPECT_FALSE(find_result(without_motion, "rate_hardness").note.empty());
  Recording free = presses(500.0, Vec3::UnitZ());
  for (Vec3& f : free.f_W_N) f.setZero();
  for (const auto& result : press_metrics(free, free.f_W_N)) {
    EXPECT_EQ(result.status, MetricStatus::missing) << result.name;
    EXPECT_THAT(result.note, ::testing::HasSubstr("no direction"));
  }
  Recording bad = presses(500.0, Vec3::UnitZ());
  auto rendered = bad.f_W_N;
  rendered[5].z() = std::nan("");
  for (const auto& result : press_metrics(bad, rendered)) EXPECT_EQ(result.status, MetricStatus::missing);
}

}  // namespace
}  // namespace touchstone::perception
