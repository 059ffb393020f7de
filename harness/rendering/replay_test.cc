#include "harness/rendering/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/rendering/cost_histogram.h"
#include "harness/rendering/replay_file.h"

namespace touchstone::rendering {
namespace {

// A plane z = 0 with k = 1 N/m; answers NaN at x = 666 to test what replay does with it.
class Plane final : public Renderer {
  void do_reset() override { ++resets; }
  StepResult do_step(const TipState& tip) noexcept override {
    StepResult result;
    result.contact_W_m = tip.p_W_m;
    result.contact = tip.p_W_m.z() < 0.0;
    if (result.contact) result.contact_W_m.z() = 0.0;
    result.f_W_N = result.contact_W_m - tip.p_W_m;
    if (tip.p_W_m.x() == 666.0) result.f_W_N.x() = std::nan("");
    return result;
  }

 public:
  int resets = 0;
};

recording::InTrajectory taps(std::size_t size) {
  recording::InTrajectory trajectory;
  for (std::size_t i = 0; i < size; ++i) {
    trajectory.motion.t_s.push_back(static_cast<double>(i) * 1e-3);
    trajectory.motion.p_W_m.emplace_back(0.0, 0.0, std::sin(static_cast<double>(i) * 0.1));
  }
  return trajectory;
}

TEST(Replay, StepsOncePerSampleInOrderAcrossBlocks) {
  for (const std::size_t size : {0, 1, 1023, 1024, 1025, 5000}) {
    Plane plane;
    const auto trajectory = taps(size);
    const auto rendered = replay(plane, trajectory);
    ASSERT_EQ(rendered.size(), size);
    EXPECT_EQ(plane.resets, 1);
    EXPECT_TRUE(rendered.cost_us.empty());
    for (std::size_t i = 0; i < size; ++i) {
      const double z = trajectory.motion.p_W_m[i].z();
      ASSERT_EQ(rendered.t_s[i], trajectory.motion.t_s[i]);
      ASSERT_EQ(rendered.f_W_N[i].z(), z < 0.0 ? -z : 0.0);
      ASSERT_EQ(rendered.contact[i], z < 0.0 ? 1 : 0);
    }
  }
}

TEST(Replay, NamesTheSampleThatWentWrong) {
  Plane plane;
  auto trajectory = taps(3000);
  trajectory.motion.p_W_m[2000].x() = 666.0;
  try {
    replay(plane, trajectory);
    FAIL();
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("sample 2000 (t = 2 s"));
  }
  trajectory = taps(10);
  trajectory.motion.t_s[5] = trajectory.motion.t_s[4];
  try {
    replay(plane, trajectory);
    FAIL();
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("sample 5"));
  }
}

TEST(Replay, TimingHasEveryKeyAndConsistentOrder) {
  Plane plane;
  const auto trajectory = taps(5000);
  const auto timing = measure_steps(plane, [&] { return tip_source(trajectory.motion); });
  EXPECT_EQ(timing.steps, 5000U);
  EXPECT_LE(timing.median_us, timing.p99_us);
  EXPECT_LE(timing.p99_us, timing.p999_us);
  EXPECT_LE(timing.p999_us, timing.max_us);
  EXPECT_GT(timing.mean_us, 0.0);
  const auto json = nlohmann::json::parse(timing_to_json(timing));
  for (const char* key :
       {"steps", "mean_us", "median_us", "p99_us", "p999_us", "max_us", "build_ms", "memory_bytes", "operations"})
    EXPECT_TRUE(json.contains(key)) << key;
  // A renderer that does not say what memory it has is not one without.
  EXPECT_TRUE(json["memory_bytes"].is_null());
  EXPECT_THAT(timing_text(timing), ::testing::EndsWith("memory unknown\n"));
  EXPECT_EQ(replay(plane, trajectory, true).cost_us.size(), 5000U);
}

TEST(CostHistogram, QuantilesAgainstSortingWithinTheStatedError) {
  Random random(7);
  CostHistogram histogram;
  std::vector<double> values;
  for (int i = 0; i < 20000; ++i) {
    values.push_back(random.log_uniform(2.0, 1e9));
    histogram.add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double q : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999}) {
    const double exact = values[static_cast<std::size_t>(std::ceil(q * 20000.0)) - 1];
    EXPECT_NEAR(histogram.quantile_ns(q) / exact, 1.0, 0.004) << q;
  }
  EXPECT_EQ(histogram.max_ns(), values.back());
  EXPECT_TRUE(std::isnan(CostHistogram().quantile_ns(0.5)));
}

}  // namespace
}  // namespace touchstone::rendering
