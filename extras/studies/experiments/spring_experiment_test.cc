#include "experiments/spring_experiment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/spring_page.h"
#include "experiments/spring_seed.h"
#include "harness/base/error.h"
#include "harness/perception/published_tables.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;

TEST(PressMotion, HasItsStrokeBeatAndSeed) {
  const PressMotion motion;
  const auto depths = press_depths_m(motion, 1000.0, 3);
  ASSERT_EQ(depths.size(), 10000u);
  EXPECT_EQ(press_depths_m(motion, 1000.0, 3), depths);
  EXPECT_NE(press_depths_m(motion, 1000.0, 4), depths);
  for (std::ptrdiff_t press = 0; press < 10; ++press) {
    const auto begin = depths.begin() + 1000 * press;
    EXPECT_NEAR(*std::max_element(begin, begin + 1000), motion.stroke_m, 5.0 * motion.stroke_spread * motion.stroke_m);
  }
  // The same motion at another rate: a function of time.
  const auto fine = press_depths_m(motion, 4000.0, 3);
  for (std::size_t n = 0; n < depths.size(); ++n) EXPECT_NEAR(fine[4 * n], depths[n], 1e-15);
}

TEST(SpringConditions, AreOrdinaryModelsWithTheDevicesOfTable1) {
  for (const auto rule : {QuadraticRule::equal_at_full_stroke, QuadraticRule::same_number}) {
    SpringSetup setup;
    setup.rule = rule;
    const auto conditions = spring_conditions(setup);
    ASSERT_EQ(conditions.size(), 6u);
    for (const auto& condition : conditions) {
      const rendering::Model again = rendering::parse_model(model_to_json(condition.model), "again.json");
      EXPECT_EQ(again.renderer, condition.linear ? "spring-linear" : "spring-quadratic");
      const auto signal = press_condition(setup, condition, 1, 0);
      ASSERT_EQ(signal.t_s.size(), 10000u);
      double limit = 0.0;
      for (const auto& device : pc::published::devices) {
        if (device.name == condition.device) limit = device.maximum_force_N;
      }
      const double peak = *std::max_element(signal.force_N.begin(), signal.force_N.end());
      EXPECT_LE(peak, limit + 6.0 * setup.force_noise_N + setup.force_step_N) << condition.name;
      if (rule == QuadraticRule::same_number && !condition.linear) {
        EXPECT_GT(peak, 0.97 * limit) << condition.name << " must saturate";
      }
    }
  }
}

TEST(SpringConditions, TheRealSpringIsLinearWithinItsSensors) {
  const SpringSetup setup;
  const auto real = press_real_spring(setup, 1);
  double worst = 0.0;
  for (std::size_t n = 0; n < real.t_s.size(); ++n) {
    worst = std::max(worst, std::abs(real.force_N[n] - setup.stiffness_N_per_m * real.displacement_m[n]));
  }
  EXPECT_GT(worst, 0.01);
  EXPECT_LT(worst, 6.0 * std::hypot(setup.force_noise_N, setup.stiffness_N_per_m * setup.distance_noise_m) +
                       setup.force_step_N);
}

TEST(Findings, AreTrueOfThePapersOwnTables) {
  Costs costs;
  for (const auto& own : pc::published::published_conditions) {
    costs.space.push_back(own.distance);
    costs.euclidean.push_back(own.euclidean);
    costs.pearson.push_back(1.0 - own.pearson);
  }
  const std::vector<double> equal(6, 1.0);
  for (const auto& finding : spring_findings()) {
    EXPECT_TRUE(finding.holds(costs)) << finding.statement;
    EXPECT_FALSE(finding.holds({equal, equal, equal})) << finding.statement;
  }
}

TEST(Share, WilsonsInterval) {
  // Newcombe (1998), table I: 81 of 263 is 0.2553 to 0.3662.
  const Share share{81, 263};
  EXPECT_NEAR(share.low95(), 0.2553, 5e-5);
  EXPECT_NEAR(share.high95(), 0.3662, 5e-5);
  EXPECT_EQ((Share{0, 100}).value(), 0.0);
  EXPECT_NEAR((Share{0, 100}).low95(), 0.0, 1e-12);
}

// One seed; the experiment itself runs a hundred. What is asserted here holds in all of them.
TEST(SpringExperiment, RunsReproduciblyAndTellsWhatHolds) {
  const auto experiment = run_spring_experiment(1, 1, {});
  // Again, by way of the text that is kept of a seed.
  const SpringSeed seed = spring_seed_from_json(spring_seed_to_json(run_spring_seed(1, true, {})));
  EXPECT_EQ(spring_experiment_to_json(experiment), spring_experiment_to_json(gather_springs(1, {seed})));
  EXPECT_THROW(spring_seed_from_json("{}"), BadData);
  ASSERT_EQ(experiment.variants.size(), spring_variants().size());
  for (const auto& own : experiment.variants) {
    EXPECT_GE(own.mean_explained_share, 0.9) << own.variant.name;
    EXPECT_EQ(own.features.size(), 4u);
    // Where no device saturates on the linear spring, it is nearer by both; the excess of the quadratic one is cut.
    if (own.variant.name == "light press") {
      EXPECT_EQ(own.findings[0][0].held, 1u);
      EXPECT_EQ(own.findings[2][0].held, 1u);
      EXPECT_EQ(own.findings[4][0].held, 1u);
    }
  }
  const auto json = nlohmann::json::parse(spring_experiment_to_json(experiment));
  EXPECT_EQ(json["schema"], "touchstone-springs/1");
  EXPECT_EQ(json["variants"][0]["findings"][0]["by_scaling"]["reference-norm"]["of"], 1);
  const report::Page page = spring_page(experiment, {});
  EXPECT_GT(page.sections.size(), 8u);
}

}  // namespace
}  // namespace touchstone::experiments
