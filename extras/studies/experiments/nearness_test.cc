#include "experiments/nearness.h"

#include <gtest/gtest.h>

#include "harness/base/error.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;

// A real process and conditions as images of one feature, which the distances are made from.
pc::PerceptualEvaluation comparison(const std::vector<std::vector<double>>& rows) {
  pc::PerceptualEvaluation result;
  for (const auto& row : rows) {
    pc::HapticImage image;
    image.blocks.push_back({"force rate", "N/s", row});
    result.images.push_back(image);
  }
  result.conditions.resize(rows.size() - 1);
  return result;
}

TEST(Nearness, MedianDistancesAndCountsUnderEveryRule) {
  // All on one line through the real process, so that one component holds everything.
  const auto first = comparison({{3, 4}, {3, 5}, {3, 16}});
  const auto second = comparison({{3, 4}, {3, 6}, {3, 3}});
  const auto rows = nearness({&first, &second});
  ASSERT_EQ(rows.size(), 2 * pc::feature_scalings.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& own = rows[i];
    EXPECT_EQ(own.scaling, pc::feature_scalings[i % pc::feature_scalings.size()]);
    EXPECT_EQ(own.explained_share, i < pc::feature_scalings.size() ? 0.9 : 1.0);
    EXPECT_EQ(own.compared, 2U);
    // Measured again: 1 and 2 away. Rendered: 12 and 1 away, nearer the second time.
    EXPECT_EQ(own.nearer, (std::vector<std::size_t>{0, 1})) << pc::name_of(own.scaling);
    if (own.scaling == pc::FeatureScaling::none) {
      EXPECT_NEAR(own.median_distance[0], 1.5, 1e-12);
      EXPECT_NEAR(own.median_distance[1], 6.5, 1e-12);
    }
    if (own.scaling == pc::FeatureScaling::reference_norm) {  // |(3, 4)| = 5
      EXPECT_NEAR(own.median_distance[0], 0.3, 1e-12);
      EXPECT_NEAR(own.median_distance[1], 1.3, 1e-12);
    }
  }
  const report::Table table = nearness_table(rows, {"again", "spring"});
  ASSERT_EQ(table.columns.size(), 5U);
  EXPECT_EQ(table.rows[1].cells[0].text, "none");
  EXPECT_EQ(table.rows[1].cells[1].text, "90 %");
  EXPECT_EQ(table.rows[1].cells[2].text, "1.5");
  EXPECT_EQ(table.rows[1].cells[4].text, "1 of 2");
  EXPECT_EQ(table.rows[1].cells[4].tone, report::Tone::warning);
  EXPECT_EQ(table.rows[6].cells[1].text, "all");
}

// What the two shares are for: near conditions that differ along an axis which far ones drown.
TEST(Nearness, NinetyPercentMayLeaveOutWhereTheNearOnesDiffer) {
  const auto own = comparison({{0, 100}, {1, 100}, {0, 200}, {0, 0}});
  const auto rows = nearness({&own});
  const std::size_t none = 1;
  ASSERT_EQ(rows[none].scaling, pc::FeatureScaling::none);
  EXPECT_LT(rows[none].median_distance[0], 0.02);
  EXPECT_NEAR(rows[none + pc::feature_scalings.size()].median_distance[0], 1.0, 1e-9);
}

TEST(Nearness, RefusesNothingAndUnequalComparisons) {
  EXPECT_THROW(nearness({}), BadData);
  const auto two = comparison({{3, 4}, {3, 5}, {3, 16}});
  const auto one = comparison({{3, 4}, {3, 5}});
  EXPECT_THROW(nearness({&two, &one}), BadData);
  EXPECT_THROW(nearness({&one, &two}), BadData);
  const auto bad = comparison({{3, 4}, {3, std::nan("")}});
  EXPECT_THROW(nearness({&bad}), BadData);
}

}  // namespace
}  // namespace touchstone::experiments
