#include <cmath>
#include <limits>
#include <numbers>

#include "harness/base/random.h"
#include "harness/metrics/catalogue.h"
#include "harness/metrics/force_axes.h"
#include "harness/metrics/force_direction.h"
#include "harness/metrics/force_error.h"

namespace touchstone::metrics {
namespace {

MetricSample forces(double t_s, const Vec3& measured, const Vec3& rendered) {
  MetricSample sample;
  sample.t_s = t_s;
  sample.f_measured_W_N = measured;
  sample.f_rendered_W_N = rendered;
  return sample;
}

// Errors of 5, 0 and 13 N: mean 6, mean square (25 + 169)/3.
std::vector<MetricSample> three() {
  return {forces(0.0, {0, 0, 0}, {3, 4, 0}), forces(0.1, {1, 2, 3}, {1, 2, 3}), forces(0.2, {0, 0, 13}, {0, 0, 0})};
}

TEST(ForceError, EquationThreeAsPrintedAndAsItsTextCallsIt) {
  ForceError metric;
  for (const MetricSample& sample : three()) metric.add(sample);
  const auto results = metric.results();
  EXPECT_EQ(find_result(results, "mean_force_error").value, 6.0);
  EXPECT_DOUBLE_EQ(find_result(results, "rms_force_error").value, std::sqrt(194.0 / 3.0));
  EXPECT_EQ(find_result(results, "max_force_error").value, 13.0);
  EXPECT_EQ(find_result(results, "max_force_error").t_s, 0.2);
  EXPECT_DOUBLE_EQ(*find_result(results, "rms_force_error").reference, std::sqrt((0.0 + 14.0 + 169.0) / 3.0));
  // Each error beside the same figure of the measured force: mean beside mean, largest beside largest.
  EXPECT_DOUBLE_EQ(*find_result(results, "mean_force_error").reference, (0.0 + std::sqrt(14.0) + 13.0) / 3.0);
  EXPECT_DOUBLE_EQ(*find_result(results, "max_force_error").reference, 13.0);
  const Series& series = *find_result(results, "rms_force_error").series;
  EXPECT_EQ(series.value, (std::vector<double>{5.0, 0.0, 13.0}));
  EXPECT_EQ(find_result(results, "rms_force_error").histogram->total(), 3u);
}

TEST(ForceAxes, RmsAndBiasPerAxis) {
  ForceAxes metric;
  for (const MetricSample& sample : three()) metric.add(sample);
  const auto results = metric.results();
  EXPECT_DOUBLE_EQ(find_result(results, "rms_force_error_x").value, std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(find_result(results, "rms_force_error_y").value, std::sqrt(16.0 / 3.0));
  EXPECT_DOUBLE_EQ(find_result(results, "rms_force_error_z").value, std::sqrt(169.0 / 3.0));
  EXPECT_EQ(find_result(results, "bias_force_error_x").value, 1.0);
  EXPECT_DOUBLE_EQ(find_result(results, "bias_force_error_z").value, -13.0 / 3.0);
}

TEST(ForceDirection, AngleOnlyAboveTheFloor) {
  MetricOptions options;
  options.force_floor_N = 0.5;
  ForceDirection metric(options);
  metric.add(forces(0.0, {0, 0, 1}, {0, 2, 2}));    // 45 degrees, magnitude off by sqrt(8) - 1
  metric.add(forces(0.1, {0, 0, 1}, {0, 0.4, 0}));  // rendered below the floor: no angle
  metric.add(forces(0.2, {1, 0, 0}, {-1, 0, 0}));   // 180 degrees
  const auto results = metric.results();
  EXPECT_NEAR(find_result(results, "mean_force_angle_error").value, (45.0 + 180.0) / 2.0, 1e-12);
  EXPECT_NEAR(find_result(results, "max_force_angle_error").value, 180.0, 1e-12);
  EXPECT_EQ(find_result(results, "max_force_angle_error").t_s, 0.2);
  EXPECT_DOUBLE_EQ(find_result(results, "bias_force_magnitude_error").value, (std::sqrt(8.0) - 1.0 - 0.6 + 0.0) / 3.0);
  EXPECT_NE(find_result(results, "mean_force_angle_error").note.find("2 of 3 samples"), std::string::npos);
}

TEST(ForceDirection, NoSampleAboveTheFloorIsMissingNotZero) {
  ForceDirection metric(MetricOptions{});
  metric.add(forces(0.0, Vec3::Zero(), Vec3::Zero()));
  const auto results = metric.results();
  EXPECT_EQ(find_result(results, "mean_force_angle_error").status, MetricStatus::missing);
  EXPECT_TRUE(std::isnan(find_result(results, "mean_force_angle_error").value));
  EXPECT_EQ(find_result(results, "rms_force_magnitude_error").value, 0.0);
}

TEST(AngleDeg, KeepsItsDigitsNearZeroAndHalfATurn) {
  for (const double angle : {1e-12, 1e-9, 1e-3, 1.0, std::numbers::pi - 1e-3, std::numbers::pi - 1e-9}) {
    for (const double scale : {1e-150, 1e-3, 1.0, 1e3, 1e150}) {
      const Vec3 a = scale * Vec3(1, 0, 0);
      const Vec3 b = Vec3(std::cos(angle), std::sin(angle), 0) / scale;
      const double expected = angle * 180.0 / std::numbers::pi;
      // Eight roundings of 1.1e-16 in each of the small vectors' components, and those of cos near half a turn.
      EXPECT_NEAR(angle_deg(a, b), expected, 180.0 / std::numbers::pi * 4e-16 + 4e-15 * expected)
          << angle << ' ' << scale;
    }
  }
}

// Turning the whole world changes no Euclidean error; per-axis squares still add up to the total.
TEST(ForceMetrics, InvariantUnderRotation) {
  Random random(5);
  for (int world = 0; world < 20; ++world) {
    const Quat turn = random.rotation();
    const double scale = random.log_uniform(1e-3, 1e3);
    ForceError plain, turned;
    ForceAxes axes;
    MetricOptions options;
    options.force_floor_N = 0.1 * scale;
    ForceDirection angle(options), turned_angle(options);
    for (int i = 0; i < 200; ++i) {
      const Vec3 a = scale * random.uniform(0.0, 2.0) * random.direction();
      const Vec3 b = scale * random.uniform(0.0, 2.0) * random.direction();
      plain.add(forces(i, a, b));
      angle.add(forces(i, a, b));
      turned.add(forces(i, turn * a, turn * b));
      turned_angle.add(forces(i, turn * a, turn * b));
      axes.add(forces(i, turn * a, turn * b));
    }
    const auto one = plain.results();
    const auto other = turned.results();
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i].value, other[i].value, 1e-14 * one[i].value);
    const auto split = axes.results();
    const double total = std::hypot(split[0].value, split[1].value, split[2].value);
    EXPECT_NEAR(total, one[0].value, 1e-14 * total);
    EXPECT_NEAR(find_result(angle.results(), "mean_force_angle_error").value,
                find_result(turned_angle.results(), "mean_force_angle_error").value, 1e-12 * 180.0);
  }
}

}  // namespace
}  // namespace touchstone::metrics
