#include "smoothing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/testing/steps.h"

namespace touchstone::acquisition {
namespace {

std::vector<double> times(double rate, double length, double jitter, Random& random) {
  std::vector<double> t;
  for (int i = 0; i < length * rate; ++i) t.push_back((i + jitter * random.uniform(-0.5, 0.5)) / rate);
  return t;
}

std::vector<double> inner(const std::vector<double>& t, double margin) {
  return testing::steps(t.front() + margin, t.back() - margin, 1.0 / 60);
}

TEST(Smoothing, HasTheStatedBandwidth) {
  Random random(5);
  const auto t = times(5000, 4, 0.0, random);
  const auto q = inner(t, 0.5);
  for (const double cutoff : {5.0, 20.0, 100.0}) {
    for (const double factor : {0.1, 0.5, 1.0, 2.0}) {
      const double omega = 2 * std::numbers::pi * cutoff * factor;
      std::vector<Vec3> wave;
      for (const double x : t) wave.push_back(Vec3(std::sin(omega * x), std::cos(omega * x), 1.0));
      const auto smoothed = smooth_at(t, wave, q, cutoff, "wave");
      const double expected = std::exp(-std::numbers::ln2 / 2 * factor * factor);  // 1/sqrt(2) at the cutoff
      for (std::size_t i = 0; i < q.size(); ++i) {
        EXPECT_NEAR(smoothed.values[i].x(), expected * std::sin(omega * q[i]), 2e-3);  // without phase lag
        EXPECT_NEAR(smoothed.values[i].z(), 1.0, 1e-12);
      }
      EXPECT_EQ(smoothed.bandwidth_Hz, cutoff);
    }
  }
}

TEST(Smoothing, KeepsStraightLinesExactlyOnUnevenSamplesToTheEnds) {
  Random random(6);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto t = times(200, 3, 0.9, random);
    std::vector<Vec3> line;
    for (const double x : t) line.push_back(scale * Vec3(1 + 2 * x, -x, 0.5));
    const auto smoothed = smooth_at(t, line, t, 10, "line");
    for (std::size_t i = 0; i < t.size(); ++i) EXPECT_LT((smoothed.values[i] - line[i]).norm(), 1e-11 * scale) << i;
  }
}

TEST(Smoothing, SaysHowMuchNoiseItLeaves) {
  Random random(7);
  const auto t = times(5000, 20, 0.0, random);
  std::vector<Vec3> noise;
  for (std::size_t i = 0; i < t.size(); ++i) noise.push_back(Vec3(random.normal(), random.normal(), random.normal()));
  const auto q = inner(t, 0.5);
  const auto smoothed = smooth_at(t, noise, q, 30, "noise");
  double sum = 0.0;
  for (const Vec3& v : smoothed.values) sum += v.squaredNorm() / (3.0 * static_cast<double>(q.size()));
  EXPECT_NEAR(std::sqrt(sum) / smoothed.noise_gain, 1.0, 0.05);
}

TEST(Smoothing, RefusesGapsAndTimesOutside) {
  std::vector<double> t;
  std::vector<Vec3> v;
  for (int i = 0; i < 100; ++i) t.push_back(0.01 * i + (i >= 50 ? 1.0 : 0.0)), v.push_back(Vec3::Ones());
  EXPECT_THROW(smooth_at(t, v, {1.0}, 30, "force"), BadData);
  EXPECT_THROW(smooth_at(t, v, {9.0}, 30, "force"), BadData);
  EXPECT_THROW(smooth_at(t, v, {0.2}, 0.0, "force"), BadData);
  EXPECT_THROW(lerp_at(t, v, {-5.0}, "motion"), BadData);
  EXPECT_NO_THROW(smooth_at(t, v, {0.2}, 30, "force"));
}

TEST(Smoothing, TurnsOrientationsEvenly) {
  const std::vector<double> t{0.0, 1.0};
  const std::vector<Quat> q{Quat::Identity(), Quat(Eigen::AngleAxisd(1.0, Vec3::UnitX()))};
  EXPECT_NEAR(slerp_at(t, q, {0.25}, "q")[0].angularDistance(Quat(Eigen::AngleAxisd(0.25, Vec3::UnitX()))), 0.0, 1e-12);
}

}  // namespace
}  // namespace touchstone::acquisition
