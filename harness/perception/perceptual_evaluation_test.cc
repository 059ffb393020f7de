#include "harness/perception/perceptual_evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::perception {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

struct Spring {
  double k = 500.0;
  double exponent = 1.0;
  double noise_N = 0.0;
  double ceiling_N = 1e9;
  double rate_Hz = 1000.0;
  double duration_s = 4.0;
  double scale = 1.0;  // of both force and displacement
};

std::vector<PressSignal> presses(const std::string& name, const Spring& spring, std::uint64_t seed = 1) {
  PressSignal signal;
  signal.name = name;
  Random random(seed);
  const double peak = spring.k * 0.01;
  for (int n = 0; n < static_cast<int>(spring.duration_s * spring.rate_Hz); ++n) {
    const double t = n / spring.rate_Hz;
    const double share = 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * t));
    signal.t_s.push_back(t);
    signal.displacement_m.push_back(spring.scale * 0.01 * share);
    const double force = std::min(peak * std::pow(share, spring.exponent), spring.ceiling_N);
    signal.force_N.push_back(spring.scale * (force + spring.noise_N * random.normal()));
  }
  return {signal};
}

ConditionSource source(const std::string& name, const Spring& spring, std::uint64_t seed = 1) {
  return {name, [=] { return presses(name, spring, seed); }};
}

std::string refused(const std::vector<PressSignal>& real, const std::vector<ConditionSource>& conditions) {
  try {
    evaluate(real, conditions, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(PerceptualEvaluation, RanksTheSpringsByTheirLikenessByEveryMethod) {
  const auto real = presses("real", {.noise_N = 0.01}, 2);
  const auto result = evaluate(real,
                               {source("same", {.noise_N = 0.01}, 3), source("softer", {.k = 400, .noise_N = 0.01}, 4),
                                source("quadratic", {.exponent = 2, .noise_N = 0.01}, 5)},
                               {});
  ASSERT_EQ(result.conditions.size(), 3u);
  EXPECT_EQ(result.conditions[0].rank_perception, 1u);
  EXPECT_EQ(result.conditions[1].rank_perception, 2u);
  EXPECT_EQ(result.conditions[2].rank_perception, 3u);
  for (const auto& method : statistical_methods()) {
    const auto values = result.values(method.method.name);
    const double sign = method.method.larger_is_better ? -1.0 : 1.0;
    EXPECT_LT(sign * values[0], sign * values[1]) << method.method.name;
  }
  EXPECT_EQ(result.features.size(), 4u);
  EXPECT_GE(result.space.explained_share, 0.9);
  EXPECT_EQ(result.windows.size(), 4u);
  EXPECT_GT(result.real.force_reduction, 0.9);
  EXPECT_EQ(result.real.statistics[0].value(), 0.0);
  EXPECT_EQ(result.real.statistics[1].value(), 1.0);
  // What a distance is made of adds up to it, but for the components that were left out.
  for (const auto& c : result.conditions) {
    double squares = 0.0;
    for (const double d : c.block_distance) squares += d * d;
    EXPECT_LE(c.distance, std::sqrt(squares) * (1.0 + 1e-9));
  }
  EXPECT_GT(result.conditions[2].distance, 0.9 * std::hypot(result.conditions[2].block_distance[2], 0.0));
}

TEST(PerceptualEvaluation, DoesNotDependOnTheNumberOfThreads) {
  const auto real = presses("real", {.noise_N = 0.02}, 2);
  std::vector<ConditionSource> conditions;
  for (int i = 0; i < 8; ++i) {
    conditions.push_back(
        source(std::to_string(i), {.k = 500.0 + 10.0 * i, .noise_N = 0.02}, 10 + static_cast<std::uint64_t>(i)));
  }
  EvaluationOptions one;
  one.threads = 1;
  const auto serial = evaluate(real, conditions, one);
  const auto parallel = evaluate(real, conditions, {});
  for (std::size_t i = 0; i < conditions.size(); ++i)
    EXPECT_EQ(serial.conditions[i].distance, parallel.conditions[i].distance);
}

TEST(PerceptualEvaluation, OtherRatesAndLengthsAreComparedOnTheRealProcesssGrid) {
  const auto real = presses("real", {});
  const auto result = evaluate(real,
                               {source("as fast", {.k = 450}), source("faster", {.k = 450, .rate_Hz = 3000}),
                                source("shorter", {.k = 450, .duration_s = 3.5})},
                               {});
  EXPECT_EQ(result.samples, 3500u);
  EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("compared over the first 3.5 s")));
  EXPECT_NEAR(result.conditions[1].distance, result.conditions[0].distance, 0.01 * result.conditions[0].distance);
  EXPECT_NEAR(result.conditions[2].distance, result.conditions[0].distance, 1e-9);
}

TEST(PerceptualEvaluation, BadInputIsRefusedByName) {
  const auto real = presses("real", {});
  EXPECT_THAT(refused(real, {}), HasSubstr("no condition"));
  EXPECT_THAT(refused(real, {source("a", {}), source("a", {})}), HasSubstr("two conditions are called 'a'"));
  EXPECT_THAT(refused(real, {source("long", {.duration_s = 9})}),
              HasSubstr("'long' lasts 8.999 s and the real process 3.999 s"));
  EXPECT_THAT(refused(real, {source("nan", {.noise_N = std::nan("")})}), HasSubstr("nan: force of sample 1 "));
  EXPECT_THAT(refused(presses("brief", {.duration_s = 0.01}), {source("brief too", {.duration_s = 0.01})}),
              HasSubstr("too few for a rate-hardness window of 10"));
  EXPECT_THAT(refused(real, {{"two parts",
                              [&] {
                                return std::vector<PressSignal>{real[0], real[0]};
                              }}}),
              HasSubstr("has 2 measuring parts"));
}

TEST(PerceptualEvaluation, ConstantSignalsHaveNoCorrelationAndStillADistance) {
  const auto real = presses("real", {});
  const auto result = evaluate(real, {source("nothing", {.ceiling_N = 0.0}), source("same", {})}, {});
  EXPECT_TRUE(std::isnan(result.values("pearson")[0]));
  EXPECT_GT(result.conditions[0].distance, 0.5);
  EXPECT_NEAR(result.conditions[1].distance, 0.0, 1e-9);
  // A real process without force: said, and finite all the same.
  const auto silent =
      evaluate(presses("silent", {.ceiling_N = 0.0}), {source("spring", {}), source("same", {.ceiling_N = 0.0})}, {});
  EXPECT_THAT(silent.remarks, ::testing::Contains(HasSubstr("the real process has no force rate")));
  EXPECT_TRUE(std::isfinite(silent.conditions[0].distance));
  EXPECT_LT(silent.conditions[1].distance, silent.conditions[0].distance);
}

TEST(PerceptualEvaluation, AConstantRealProcessDoesNotMakeDistancesOfItsRounding) {
  // 1.2 N and 3 mm are no sums of powers of two: their resampled and filtered values are not all the same to the bit.
  auto still = presses("still", {.duration_s = 60.0});
  for (double& force : still[0].force_N) force = 1.2;
  for (double& displacement : still[0].displacement_m) displacement = 3e-3;
  const auto result = evaluate(still, {source("pressed", {.duration_s = 60.0})}, {});
  EXPECT_LT(result.conditions[0].distance, 100.0);
  EXPECT_GT(result.conditions[0].distance, 0.1);
  EXPECT_THAT(result.remarks, Contains(HasSubstr("has no spectrum")));
  EXPECT_THAT(result.remarks, Contains(HasSubstr("has no force rate")));
  for (const char* const method : {"pearson", "pearson-filtered"}) EXPECT_TRUE(std::isnan(result.values(method)[0]));
}

TEST(PerceptualEvaluation, OptionsThatMeanNothingAreRefused) {
  const auto real = presses("real", {});
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EvaluationOptions rate, band, dead_zone, tolerance;
    rate.matrix.rate_Hz = bad;
    band.image.output_band_Hz = bad;
    dead_zone.image.sensor_dead_zone_N = bad;
    tolerance.duration_tolerance = bad;
    for (const auto& options : {rate, band, dead_zone, tolerance})
      EXPECT_THROW(evaluate(real, {source("same", {})}, options), UsageError) << bad;
  }
}

TEST(PerceptualEvaluation, ASingleConditionHasADistanceAndARemark) {
  const auto result = evaluate(presses("real", {}), {source("only", {.k = 400})}, {});
  EXPECT_EQ(result.space.dimensions, 1);  // fewer conditions than dimensions: one direction
  EXPECT_GT(result.conditions[0].distance, 0.0);
  EXPECT_THAT(result.remarks, ::testing::Contains(HasSubstr("a single condition")));
  EXPECT_TRUE(relative_similarity(result.values("perception-space"), false).empty());
}

TEST(PerceptualEvaluation, ScalingsAndDisagreements) {
  const auto real = presses("real", {});
  // The clipped spring errs much where the force is high; the quadratic one is nearer in newtons but feels different.
  const auto result =
      evaluate(real, {source("clipped", {.ceiling_N = 3.0}), source("quadratic", {.exponent = 2.0})}, {});
  for (const auto scaling : feature_scalings) {
    const auto distances = distances_with_scaling(result, scaling, 0.9);
    ASSERT_EQ(distances.size(), 2u);
    if (scaling == result.scaling) {
      EXPECT_DOUBLE_EQ(distances[0], result.conditions[0].distance);
    }
  }
  std::size_t found = 0;
  for (const auto& method : statistical_methods()) {
    const Disagreements own = disagreements(result, method.method.name);
    EXPECT_EQ(own.of, 1u);
    EXPECT_EQ(own.pairs, own.most.size());
    EXPECT_TRUE(disagreements(result, method.method.name, 0).most.empty());
    for (const auto& d : own.most) {
      ++found;
      EXPECT_LT(result.conditions[d.nearer_in_space].distance, result.conditions[d.nearer_by_statistic].distance);
      EXPECT_THAT(d.why, HasSubstr(d.feature));
    }
  }
  EXPECT_GT(found, 0u);
  EXPECT_THROW(disagreements(result, "no such thing"), UsageError);
  EXPECT_THROW(static_cast<void>(result.values("no such thing")), UsageError);
}

}  // namespace
}  // namespace touchstone::perception
