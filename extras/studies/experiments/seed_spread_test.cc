#include "experiments/seed_spread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "experiments/rows.h"

namespace touchstone::experiments {
using report::Table;

namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> texts(const Table::Row& row) {
  std::vector<std::string> result;
  for (const auto& cell : row.cells) result.push_back(cell.text);
  return result;
}

SeedSpread of(const std::vector<double>& errors, const std::vector<bool>& held) {
  SeedSpread spread;
  for (std::size_t i = 0; i < errors.size(); ++i) spread.add({{"error [N]", errors[i]}}, {{"flat", held[i]}});
  return spread;
}

TEST(SeedSpread, MedianExtremesAndHowOftenAFindingHolds) {
  const auto section = spread_section(of({3.0, 1.0, 2.0}, {true, false, true}));
  ASSERT_EQ(section.blocks.size(), 2U);
  const auto& findings = std::get<Table>(section.blocks[0]);
  ASSERT_EQ(findings.rows.size(), 1U);
  EXPECT_THAT(texts(findings.rows[0]), ElementsAre("flat", "2", "3"));
  EXPECT_THAT(texts(std::get<Table>(section.blocks[1]).rows[0]), ElementsAre("error [N]", "2", "1", "3"));
  EXPECT_THAT(section.intro, HasSubstr("3 seeds"));
  // Of an even number the mean of the two in the middle.
  const auto four = spread_section(of({8.0, 1.0, 2.0, 4.0}, {false, false, false, false}));
  EXPECT_THAT(texts(std::get<Table>(four.blocks[1]).rows[0]), ElementsAre("error [N]", "3", "1", "8"));
  EXPECT_THAT(texts(std::get<Table>(four.blocks[0]).rows[0]), ElementsAre("flat", "0", "4"));
  EXPECT_THAT(spread_table(of({8.0, 1.0}, {true, true})), HasSubstr("Over 2 seeds"));
}

TEST(SeedSpread, OneSeedOrNoneHasNoSpread) {
  EXPECT_EQ(spread_table({}), "");
  EXPECT_TRUE(spread_section({}).blocks.empty());
  EXPECT_EQ(spread_table(of({1.0}, {true})), "");
  EXPECT_THAT(spread_section(of({1.0}, {true})).intro, HasSubstr("--seeds"));
}

TEST(SeedSpread, AValueThatASeedLacksIsNotMadeUp) {
  const auto section = spread_section(of({3.0, std::nan(""), 2.0}, {true, true, true}));
  EXPECT_THAT(texts(std::get<Table>(section.blocks[1]).rows[0]), ElementsAre("error [N]", "none", "none", "none"));
}

TEST(SeedSpread, RefusesASeedWithOtherValuesOrFindings) {
  auto spread = of({3.0, 1.0}, {true, true});
  EXPECT_THROW(spread.add({}, {{"flat", true}}), std::invalid_argument);
  EXPECT_THROW(spread.add({{"other", 1.0}}, {{"flat", true}}), std::invalid_argument);
  EXPECT_THROW(spread.add({{"error [N]", 1.0}}, {{"flat", true}, {"steep", true}}), std::invalid_argument);
  EXPECT_EQ(spread.values[0].of_seed.size(), 2U);
}

TEST(TableOf, WordsStandLeftAndEveryRowIsWhole) {
  const Table table = table_of({{"a", "b", "c"}, {"1", "2", "3"}}, "caption", 2);
  EXPECT_EQ(table.caption, "caption");
  EXPECT_THAT(table.columns, ElementsAre("a", "b", "c"));
  EXPECT_FALSE(table.rows[0].cells[1].number);
  EXPECT_TRUE(table.rows[0].cells[2].number);
  EXPECT_TRUE(table_of({{"a"}}, "").rows.empty());
  EXPECT_THROW(table_of({}, ""), std::invalid_argument);
  EXPECT_THROW(table_of({{"a", "b"}, {"1"}}, ""), std::invalid_argument);
  EXPECT_THROW(table_of({{"a"}, {"1", "2"}}, ""), std::invalid_argument);
}

}  // namespace
}  // namespace touchstone::experiments
