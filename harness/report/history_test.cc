#include "harness/report/history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone {
namespace {

class HistoryFile : public testing::Test {
 protected:
  std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) /
      (std::string("history_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".jsonl");
  void SetUp() override { std::filesystem::remove(file); }
  void TearDown() override { std::filesystem::remove(file); }
};

TEST_F(HistoryFile, WhatIsAppendedIsReadBack) {
  append_history(file, {"a1", "2026-01-01", 0.1}, "force_rms_N", "golden.x.y");
  append_history(file, {"a1", "", 7.0}, "operations", "golden.x.y");
  append_history(file, {"b2", "", 0.2}, "force_rms_N", "golden.other.y");
  append_history(file, {"b2", "", 0.3}, "force_rms_N", "golden.x.y");
  const auto history = load_history(file, "force_rms_N", "golden.x.y");
  ASSERT_EQ(history.size(), 2U);
  EXPECT_EQ(history[0].commit, "a1");
  EXPECT_EQ(history[0].value, 0.1);
  EXPECT_EQ(history[1].value, 0.3);
  EXPECT_EQ(load_history(file, "force_rms_N", "").size(), 3U);
  EXPECT_THROW(append_history(file, {"c", "", NAN}, "force_rms_N", ""), BadData);
}

TEST_F(HistoryFile, ABadLineIsNamed) {
  write_file(file,
             "{\"commit\": \"a\", \"metric\": \"m\", \"value\": 1}\n{\"commit\": \"b\", \"metric\": \"m\", \"value\": "
             "null}\n");
  try {
    load_history(file, "m", "");
    FAIL() << "accepted";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("line 2"));
  }
}

TEST(Steps, APlantedStepIsFoundAtItsPlace) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Random random(5);
    std::vector<double> values;
    for (int i = 0; i < 60; ++i) values.push_back(scale * ((i < 40 ? 1.0 : 1.2) + 0.02 * random.normal()));
    const auto steps = find_steps(values);
    ASSERT_EQ(steps.size(), 1U) << "scale " << scale;
    EXPECT_EQ(steps[0].index, 40U);
    EXPECT_NEAR(steps[0].after / steps[0].before, 1.2, 0.02);
  }
}

TEST(Steps, UpAndDownAgainAreTwo) {
  std::vector<double> values(50, 1.0);
  for (std::size_t i = 20; i < 30; ++i) values[i] = 1.01;
  const auto steps = find_steps(values);
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].index, 20U);
  EXPECT_EQ(steps[1].index, 30U);
}

// Over many histories of noise alone, few steps are claimed.
TEST(Steps, NoiseAloneRarelyShowsOne) {
  int claimed = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    std::vector<double> values;
    for (int i = 0; i < 50; ++i) values.push_back(1.0 + 0.1 * random.normal());
    claimed += find_steps(values).empty() ? 0 : 1;
  }
  EXPECT_LE(claimed, 20);
}

TEST(Steps, ConstantAndShortHistoriesHaveNone) {
  EXPECT_TRUE(find_steps(std::vector<double>(20, 3.0)).empty());
  EXPECT_TRUE(find_steps(std::vector<double>(20, 0.0)).empty());
  EXPECT_TRUE(find_steps({}).empty());
  EXPECT_TRUE(find_steps({1.0, 2.0}).empty());
}

TEST(Gates, HoldTheNewestValue) {
  const History history{{"a", "", 1.0}, {"b", "", 1.0}, {"c", "", 1.2}};
  EXPECT_TRUE(broken_gates(history, {}).empty());
  EXPECT_TRUE(broken_gates(history, {.maximum = 1.3, .minimum = 1.0, .most_rise = 0.25}).empty());
  EXPECT_EQ(broken_gates(history, {.maximum = 1.1, .minimum = 1.3, .most_rise = 0.1}).size(), 3U);
  EXPECT_FALSE(broken_gates({}, {.maximum = 1.0}).empty());
  EXPECT_FALSE(broken_gates({{"a", "", 1.0}}, {.most_rise = 1.0}).empty());
}

}  // namespace
}  // namespace touchstone
