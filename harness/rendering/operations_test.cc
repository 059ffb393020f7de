#include "harness/rendering/operations.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "harness/base/error.h"

namespace touchstone::rendering {
namespace {

// Its n-th step multiplies n times and adds once.
class Growing final : public Renderer {
 private:
  void do_reset() override { steps_ = 0; }
  StepResult do_step(const TipState& tip) noexcept override {
    Counted x = tip.p_W_m.x();
    ++steps_;
    for (int i = 0; i < steps_; ++i) x *= 2.0;
    x += 1.0;
    StepResult result;
    result.f_W_N.x() = x.value();
    return result;
  }
  int steps_ = 0;
};

TipSource positions(int count, double x = 1.0) {
  return [=, next = 0](TipState& tip) mutable {
    if (next == count) return false;
    tip.t_s = ++next * 1e-3;
    tip.p_W_m = {x, 0, 0};
    return true;
  };
}

TEST(Operations, MeanMedianMaximumAndTotalByHand) {
  Growing growing;
  const OperationReport odd = count_operations(growing, positions(5));  // 2, 3, 4, 5, 6
  EXPECT_EQ(odd.steps, 5U);
  EXPECT_EQ(odd.total(), 20U);
  EXPECT_EQ(odd.counts, (OperationCounts{5, 15, 0, 0, 0}));
  EXPECT_EQ(odd.mean, 4.0);
  EXPECT_EQ(odd.median, 4.0);
  EXPECT_EQ(odd.max, 6U);
  EXPECT_EQ(count_operations(growing, positions(4)).median, 3.5) << "and it resets";
  EXPECT_EQ(count_operations(growing, positions(0)).total(), 0U);
}

TEST(Operations, AsJson) {
  Growing growing;
  OperationReport report = count_operations(growing, positions(5));
  report.not_counted = "the \"effects\"";
  const auto json = nlohmann::json::parse(operations_to_json(report));
  EXPECT_EQ(json["total"], 20);
  EXPECT_EQ(json["multiply"], 15);
  EXPECT_EQ(json["median"], 4.0);
  EXPECT_EQ(json["not_counted"], "the \"effects\"");
  const auto timing = nlohmann::json::parse(timing_to_json({}, operations_to_json(report)));
  EXPECT_EQ(timing["operations"]["max"], 6);
}

TEST(Operations, ARendererThatAnswersWithNoNumberIsAnError) {
  Growing growing;
  EXPECT_THROW(count_operations(growing, positions(3, 1e308)), BadData);
}

}  // namespace
}  // namespace touchstone::rendering
