#include "harness/pipeline/discrepancy/curve_zero.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "harness/base/random.h"

namespace touchstone::pipeline {
namespace {

struct Curve {
  double from_m = 5e-3, to_m = -3e-3, zero_m = 0.0;
  double power = 1.5;
  double most_N = 1.0, noise_N = 1e-3, slope_N = 0.0;  // slope: of free air, over the whole way
  double aside_m = 0.0;
  int samples = 1000;
};

// Down and up again, at constant speed.
recording::Recording record(const Curve& curve, std::uint64_t seed = 1) {
  Random random(seed);
  recording::Recording recording;
  for (int i = 0; i <= 2 * curve.samples; ++i) {
    const double s = 1.0 - std::abs(1.0 - static_cast<double>(i) / curve.samples);
    const double z = curve.from_m + s * (curve.to_m - curve.from_m);
    const double depth = std::max(0.0, curve.zero_m - z) / (curve.zero_m - curve.to_m);
    const double f = curve.most_N * std::pow(depth, curve.power) + curve.slope_N * s + curve.noise_N * random.normal();
    recording.motion.t_s.push_back(1e-3 * i);
    recording.motion.p_W_m.emplace_back(curve.aside_m * s, 0.0, z);
    recording.f_W_N.emplace_back(0.0, 0.0, f - 0.3 * curve.most_N);
  }
  recording.motion.q_WS.assign(recording.motion.t_s.size(), Quat::Identity());
  return recording;
}

double depth_of(const Curve& curve) { return curve.zero_m - curve.to_m; }

TEST(CurveZero, IsWhereTheForceBegins) {
  for (const double power : {1.0, 1.5, 2.0}) {
    for (const double noise_N : {1e-4, 1e-2}) {
      Curve curve{.from_m = 0.046, .to_m = 0.038, .zero_m = 0.041, .power = power, .noise_N = noise_N};
      curve.slope_N = 0.05;
      const auto found = find_curve_zero(record(curve));
      ASSERT_TRUE(found) << power;
      // Nothing tells it nearer than to the depth at which the force leaves the noise.
      const double hidden = std::pow(noise_N / curve.most_N, 1.0 / power);
      EXPECT_NEAR(found->z_W_m, curve.zero_m, (hidden + 0.03) * depth_of(curve)) << power << ", " << noise_N;
      EXPECT_NEAR(found->deepest_m, found->z_W_m - curve.to_m, 1e-15);
    }
  }
}

// The scale of an atomic force microscope and of a testing machine; a file's zero below everything and above it.
TEST(CurveZero, IsTheSameAtEveryScaleAndFromEveryZero) {
  for (const double scale : {1e-6, 1.0, 1e2}) {
    for (const double shift : {-0.1, 0.1}) {
      Curve curve{.from_m = 0.005, .to_m = -0.003, .zero_m = 0.0};
      for (double* const length : {&curve.from_m, &curve.to_m, &curve.zero_m}) *length = scale * (*length + shift);
      curve.most_N = scale, curve.noise_N = 1e-3 * scale;
      const auto found = find_curve_zero(record(curve));
      ASSERT_TRUE(found) << scale << ", " << shift;
      EXPECT_NEAR(found->z_W_m, curve.zero_m, 0.02 * depth_of(curve));
    }
  }
}

// Snap-in before contact, as of a wet or soft sample: the surface is where it pulls, not where free air was left.
TEST(CurveZero, AShortPullBeforeContactMovesItLittle) {
  const Curve curve{.from_m = 0.046, .to_m = 0.038, .zero_m = 0.041};
  recording::Recording recording = record(curve);
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double above = recording.motion.p_W_m[i].z() - curve.zero_m;
    if (above > 0.0 && above < 1e-4) recording.f_W_N[i].z() -= 0.05;
  }
  const auto found = find_curve_zero(recording);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->z_W_m, curve.zero_m, 0.15 * depth_of(curve));
}

TEST(CurveZero, AZeroThatServesStays) {
  for (const double off : {0.0, 0.08, -0.08}) {
    for (const double power : {1.0, 1.5, 2.0}) {
      Curve curve{.power = power};
      curve.zero_m = 3e-3 * off;
      EXPECT_FALSE(find_curve_zero(record(curve))) << off << ", " << power;
    }
  }
}

// As curve_zero.h says: no more than that.
TEST(CurveZero, ACubeSeemsToBeginDeeper) {
  const Curve curve{.from_m = 0.046, .to_m = 0.038, .zero_m = 0.041, .power = 3.0};
  const auto found = find_curve_zero(record(curve));
  ASSERT_TRUE(found);
  EXPECT_LT(found->z_W_m, curve.zero_m);
  EXPECT_NEAR(found->z_W_m, curve.zero_m, 0.35 * depth_of(curve));
}

TEST(CurveZero, IsNotSoughtWhereThereIsNone) {
  EXPECT_FALSE(find_curve_zero(record({.from_m = 0.041, .to_m = 0.038, .zero_m = 0.041}))) << "no free air";
  EXPECT_FALSE(find_curve_zero(record({.from_m = 0.046, .to_m = 0.038, .zero_m = 0.041, .most_N = 0.0}))) << "noise";
  EXPECT_FALSE(find_curve_zero(record({.from_m = 0.046, .to_m = 0.038, .zero_m = 0.041, .aside_m = 1e-3})))
      << "a slide";
  EXPECT_FALSE(find_curve_zero({}));
  EXPECT_FALSE(find_curve_zero(record({.samples = 5})));
}

}  // namespace
}  // namespace touchstone::pipeline
