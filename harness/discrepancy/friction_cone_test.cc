// Samples whose law is known: a tip that slides at all speeds, rests under part of its load, or both.
#include "harness/discrepancy/friction_cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/base/random.h"

namespace touchstone::discrepancy {
namespace {

constexpr FallingCoefficient truth{0.7, 0.25, 0.012};

double mu(double v) {
  const double ratio = v / truth.velocity_m_per_s;
  return truth.mu_dynamic + (truth.mu_static - truth.mu_dynamic) * std::exp(-ratio * ratio);
}

// Speeds from a twentieth of the law's to twenty times it, times `unit`.
std::vector<ConeSample> sliding(double unit, double noise) {
  Random random(71);
  std::vector<ConeSample> samples;
  for (int i = 0; i < 1500; ++i) {
    const double v = truth.velocity_m_per_s * std::pow(20.0, random.uniform(-1.0, 1.0));
    samples.push_back({mu(v) * (1.0 + noise * random.normal()), unit * v});
  }
  return samples;
}

// A tip that rests holds anything up to the static coefficient.
std::vector<ConeSample> with_rests(std::vector<ConeSample> samples, double unit) {
  Random random(72);
  for (int i = 0; i < 1000; ++i) {
    samples.push_back({0.3 * truth.mu_static * random.uniform(), unit * 1e-3 * truth.velocity_m_per_s});
  }
  return samples;
}

TEST(FrictionCone, ReadsALawAtEveryUnitFromATipThatSlides) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    const auto read = read_falling(sliding(unit, 0.02));
    ASSERT_TRUE(read.has_value());
    EXPECT_NEAR(read->mu_dynamic, truth.mu_dynamic, 0.02 * truth.mu_dynamic) << unit;
    EXPECT_NEAR(read->mu_static, truth.mu_static, 0.07 * truth.mu_static) << unit;
    EXPECT_NEAR(read->velocity_m_per_s, unit * truth.velocity_m_per_s, 0.15 * unit * truth.velocity_m_per_s) << unit;
  }
}

TEST(FrictionCone, RestsDoNotLowerWhatIsRead) {
  const auto read = read_falling(with_rests(sliding(1.0, 0.02), 1.0));
  ASSERT_TRUE(read.has_value());
  EXPECT_NEAR(read->mu_dynamic, truth.mu_dynamic, 0.02 * truth.mu_dynamic);
  EXPECT_NEAR(read->mu_static, truth.mu_static, 0.07 * truth.mu_static);
  EXPECT_NEAR(read->velocity_m_per_s, truth.velocity_m_per_s, 0.15 * truth.velocity_m_per_s);
}

TEST(FrictionCone, NoForceOfASteadyCoefficientLeavesIts) {
  auto samples = with_rests(sliding(1.0, 0.0), 1.0);
  for (ConeSample& sample : samples) sample.ratio = std::min(sample.ratio, truth.mu_dynamic);
  const auto cone = cone_of(samples);
  ASSERT_TRUE(cone.has_value());
  EXPECT_DOUBLE_EQ(cone->sliding, truth.mu_dynamic);
  EXPECT_DOUBLE_EQ(cone->excess(), 0.0);
  const auto falling = cone_of(with_rests(sliding(1.0, 0.0), 1.0));
  ASSERT_TRUE(falling.has_value());
  EXPECT_GT(falling->excess(), 1.0);
  EXPECT_LE(falling->widest, truth.mu_static);
}

TEST(FrictionCone, SamplesAreOfThePartThatCountsAlone) {
  constexpr std::size_t n = 200;
  MotionColumns likely;
  ConeEvidence evidence;
  std::vector<Vec3> shown;
  for (std::size_t i = 0; i < n; ++i) {
    likely.t_s.push_back(0.01 * static_cast<double>(i));
    likely.p_W_m.emplace_back(0.03 * likely.t_s.back(), 0.0, 0.0);
    evidence.others.n_W.emplace_back(Vec3::UnitZ());
    evidence.others.f_W_N.emplace_back(0.0, 0.0, 2.0);
    evidence.others.normal_N.push_back(2.0);
    // What is held back pulls twice as hard.
    shown.emplace_back(i < n / 2 ? -0.6 : -1.2, 0.0, 2.0);
  }
  const std::vector<ResidualBlock> blocks{{0, n / 2}};
  evidence.blocks = &blocks;
  evidence.likely = &likely;
  const auto samples = cone_samples(evidence, shown);
  ASSERT_EQ(samples.size(), n / 2 - 1);  // the first has no sample before it
  for (const ConeSample& sample : samples) {
    EXPECT_NEAR(sample.ratio, 0.3, 1e-12);
    EXPECT_NEAR(sample.along, -0.3, 1e-12);
    EXPECT_NEAR(sample.speed_m_per_s, 0.03, 1e-12);
  }
}

// A tip that goes to and fro, quicker and slower, and is pulled along by `coefficient` of its load.
std::vector<ConeSample> pulled(double coefficient, double share, bool to_and_fro) {
  Random random(74);
  std::vector<ConeSample> samples;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 direction = (to_and_fro && i % 2 == 1 ? -1.0 : 1.0) * Vec3::UnitX();
    const double along = (random.uniform() < share ? 1.0 : -1.0) * coefficient;
    samples.push_back({std::abs(along), random.uniform(0.01, 0.1), direction, along});
  }
  return samples;
}

TEST(FrictionCone, AForceThatPullsATipAlongIsNoFriction) {
  EXPECT_NEAR(pulls_along(pulled(0.21, 1.0, true)).value_or(0.0), 0.21, 1e-12);
  EXPECT_NEAR(pulls_along(pulled(0.21, 0.95, true)).value_or(0.0), 0.21, 1e-12);
  EXPECT_FALSE(pulls_along(pulled(-0.21, 1.0, true)).has_value()) << "friction resists";
  EXPECT_FALSE(pulls_along(pulled(0.21, 0.7, true)).has_value()) << "as often against the motion";
  EXPECT_FALSE(pulls_along(pulled(0.04, 1.0, true)).has_value()) << "less than slopes may be off";
  EXPECT_FALSE(pulls_along(pulled(0.21, 1.0, false)).has_value()) << "a slope may pull to one side";
  EXPECT_FALSE(pulls_along({}).has_value());
}

TEST(FrictionCone, TooFewSamplesOrNoPullTellNothing) {
  auto samples = sliding(1.0, 0.0);
  samples.resize(299);
  EXPECT_FALSE(cone_of(samples).has_value());
  EXPECT_FALSE(read_falling(samples).has_value());
  EXPECT_FALSE(read_again({}, 0).has_value());
  samples = sliding(1.0, 0.0);
  for (ConeSample& sample : samples) sample.ratio = 0.0;
  EXPECT_FALSE(cone_of(samples).has_value());
}

TEST(FrictionCone, DrawsSurroundTheTruthAndAreTheSameAgain) {
  auto samples = with_rests(sliding(1.0, 0.02), 1.0);
  Random random(73);
  for (ConeSample& sample : samples) {
    if (random.uniform() < 0.35) sample.ratio *= random.uniform(0.8, 1.0);  // bristles that turn
  }
  FallingCoefficient low{1e9, 1e9, 1e9};
  FallingCoefficient high;
  for (std::size_t draw = 0; draw < 10; ++draw) {
    const auto read = read_again(samples, draw);
    ASSERT_TRUE(read.has_value());
    low = {std::min(low.mu_static, read->mu_static), std::min(low.mu_dynamic, read->mu_dynamic),
           std::min(low.velocity_m_per_s, read->velocity_m_per_s)};
    high = {std::max(high.mu_static, read->mu_static), std::max(high.mu_dynamic, read->mu_dynamic),
            std::max(high.velocity_m_per_s, read->velocity_m_per_s)};
    EXPECT_EQ(read->mu_static, read_again(samples, draw)->mu_static);
  }
  constexpr double off = 0.05;  // of what is assumed to be sliding, beyond what the draws show
  const auto surround = [](double from, double to, double value) {
    EXPECT_LT(from, to);
    EXPECT_LT(from, (1.0 + off) * value);
    EXPECT_GT(to, (1.0 - off) * value);
  };
  surround(low.mu_static, high.mu_static, truth.mu_static);
  surround(low.mu_dynamic, high.mu_dynamic, truth.mu_dynamic);
  surround(low.velocity_m_per_s, high.velocity_m_per_s, truth.velocity_m_per_s);
}

}  // namespace
}  // namespace touchstone::discrepancy
