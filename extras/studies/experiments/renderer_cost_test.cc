#include "experiments/renderer_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::experiments {
namespace {

using ::testing::HasSubstr;

const CostOptions small{{320}, 1000, 16};

const std::vector<RendererCost>& small_costs() {
  static const auto costs = measure_costs(small);
  return costs;
}

TEST(RendererCost, EveryRendererHasItsLinesAndFiguresThatCanBe) {
  const auto& costs = small_costs();
  EXPECT_EQ(costs.size(), cost_cases(small));
  for (const auto& entry : renderers::renderer_catalogue())
    EXPECT_TRUE(std::ranges::any_of(costs, [&](const auto& own) { return own.renderer == entry.name; })) << entry.name;
  for (const auto& own : costs) {
    EXPECT_EQ(own.triangles, costs.front().triangles) << own.what;
    EXPECT_EQ(own.timing.steps, small.steps) << own.what;
    EXPECT_GT(own.timing.mean_us, 0.0) << own.what;
    EXPECT_GE(own.timing.p99_us, own.timing.median_us) << own.what;
    EXPECT_GT(own.in_contact, 0.3) << own.what;
    EXPECT_LT(own.in_contact, 0.9) << own.what;  // in the air for a third of the second
    // Counted, or a reason why not.
    if (own.operations) {
      EXPECT_GE(static_cast<double>(own.operations->max), own.operations->mean) << own.what;
      EXPECT_GT(own.operations->mean, 0.0) << own.what;
    } else {
      EXPECT_FALSE(own.not_counted.empty()) << own.what;
    }
  }
}

TEST(RendererCost, OperationsRepeatExactly) {
  const auto again = measure_costs(small);
  ASSERT_EQ(again.size(), small_costs().size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    ASSERT_EQ(again[i].what, small_costs()[i].what);
    ASSERT_EQ(again[i].operations.has_value(), small_costs()[i].operations.has_value());
    if (!again[i].operations) continue;
    EXPECT_EQ(again[i].operations->total(), small_costs()[i].operations->total());
  }
}

TEST(RendererCost, ThePathIsAsDeepAsItSaysAndInTheAirOnceASecond) {
  const auto body = synthetic::make_surface("bumpy");
  for (const double radius_m : {0.0, 1e-3}) {
    const auto tips = path_over_the_bumpy_body(radius_m, 1000);
    ASSERT_EQ(tips.size(), 1000U);
    double deepest = 0.0;
    double highest = 0.0;
    for (const Vec3& tip : tips) {
      const double depth = radius_m - body->signed_distance(tip);
      deepest = std::max(deepest, depth);
      highest = std::max(highest, -depth);
    }
    EXPECT_NEAR(deepest, 1e-3, 2e-5);
    EXPECT_NEAR(highest, 1e-4, 2e-6);
  }
}

TEST(RendererCost, TableAndJsonHoldEveryLine) {
  const auto json = nlohmann::json::parse(cost_to_json(small_costs()));
  EXPECT_EQ(json["schema"], "touchstone-renderer-cost/1");
  ASSERT_EQ(json["costs"].size(), small_costs().size());
  for (std::size_t i = 0; i < small_costs().size(); ++i) {
    EXPECT_EQ(json["costs"][i]["renderer"], small_costs()[i].renderer);
    EXPECT_EQ(json["costs"][i]["timing"]["operations"].is_null(), !small_costs()[i].operations.has_value());
  }
  const auto table = cost_table(small_costs());
  for (const auto& own : small_costs()) EXPECT_THAT(table, HasSubstr(own.what));
  const auto page = cost_page(small_costs(), {});
  EXPECT_EQ(std::get<report::Table>(page.sections.front().blocks.front()).rows.size(), small_costs().size());
}

TEST(RendererCost, RefusesNothingToMeasure) {
  EXPECT_THROW(measure_costs({{}, 100, 16}), UsageError);
  EXPECT_THROW(measure_costs({{320}, 0, 16}), UsageError);
  EXPECT_EQ(cost_cases({{320, 320, 500}, 100, 16}), 2 * cost_cases(small));
}

}  // namespace
}  // namespace touchstone::experiments
