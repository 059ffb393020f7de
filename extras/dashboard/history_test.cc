#include "history.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "history_page.h"
#include "history_verdict.h"

namespace touchstone::dashboard {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class HistoryFile : public testing::Test {
 protected:
  std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) /
      (std::string("history_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  std::filesystem::path file = folder / "history.jsonl";
  void SetUp() override {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
};

HistorySeries series_of(const std::vector<double>& values) {
  HistorySeries series{{"site", "build", "Nightly", "test", "metric"}, {}};
  for (std::size_t i = 0; i < values.size(); ++i) series.points.push_back({"c" + std::to_string(i), "", values[i]});
  return series;
}

SeriesVerdict judged(const std::vector<double>& values, const HistoryLimit& limit = {}) {
  return judge_series(series_of(values), limit, 0.01, 1);
}

std::vector<double> noisy(std::size_t count, double noise, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> values(count);
  for (double& value : values) value = 1.0 + noise * random.normal();
  return values;
}

TEST_F(HistoryFile, WhatIsAppendedIsReadBack) {
  append_history(file, {{{"", "", "", "golden.x.y", "force_rms_N"}, {{"a1", "2026-01-01", 0.1}}},
                        {{"", "", "", "golden.x.y", "operations"}, {{"a1", "", 7.0}}}});
  append_history(file, {{{"", "", "", "golden.other.y", "force_rms_N"}, {{"b2", "", 0.2}}}});
  append_history(file, {{{"", "", "", "golden.x.y", "force_rms_N"}, {{"b2", "", 0.3}}}});
  const auto history = load_history({file}, {"", "", "", "golden.x.y", "force_rms_N"});
  ASSERT_EQ(history.size(), 1U);
  ASSERT_EQ(history[0].points.size(), 2U);
  EXPECT_EQ(history[0].points[0].commit, "a1");
  EXPECT_EQ(history[0].points[0].value, 0.1);
  EXPECT_EQ(history[0].points[1].value, 0.3);
  EXPECT_EQ(load_history({file}, {"", "", "", "", "force_rms_N"}).size(), 2U);
  EXPECT_EQ(load_history({file}, {"", "", "", "golden.*", ""}).size(), 3U);
  EXPECT_THROW(append_history(file, {{{"", "", "", "", "m"}, {{"c", "", NAN}}}}), BadData);
}

// The jobs of a matrix record into one file at once: nothing is lost.
TEST_F(HistoryFile, KeepsWhatManyProcessesRecordAtOnce) {
  constexpr int jobs = 20, each = 10;
  std::vector<pid_t> children;
  for (int job = 0; job < jobs; ++job) {
    const pid_t child = ::fork();
    if (child == 0) {
      for (int i = 0; i < each; ++i)
        append_history(file, {{{"", "", "", "t", "m"}, {{fmt::format("c{}-{}", job, i), "", 1.0 * job}}}});
      ::_exit(0);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) ::waitpid(child, nullptr, 0);
  std::istringstream lines(read_file(file));
  std::set<std::string> commits;
  for (std::string line; std::getline(lines, line);) commits.insert(nlohmann::json::parse(line).at("commit"));
  EXPECT_EQ(commits.size(), static_cast<std::size_t>(jobs * each));
}

TEST_F(HistoryFile, SitesBuildNamesAndTracksAreSeriesOfTheirOwn) {
  for (const char* const site : {"lab", "ci"}) {
    for (const char* const build : {"gcc", "clang"}) {
      for (const char* const track : {"Nightly", "Experimental"})
        append_history(file, {{{site, build, track, "t", "m"}, {{"a", "", 1.0}}}});
    }
  }
  EXPECT_EQ(load_history({file}, {}).size(), 8U);
  EXPECT_EQ(load_history({file}, {"lab", "", "Nightly", "", ""}).size(), 2U);
}

TEST_F(HistoryFile, AFolderOfArtefactsIsReadOnceEachAndInOrderOfTime) {
  const HistorySeries old{{"", "", "", "t", "m"}, {{"a", "2026-01-01T00:00:00Z", 1.0}}};
  const HistorySeries late{{"", "", "", "t", "m"}, {{"b", "2026-02-01T00:00:00Z", 2.0}}};
  std::filesystem::create_directories(folder / "run-1");
  std::filesystem::create_directories(folder / "run-2");
  append_history(folder / "run-2" / "history.jsonl", {old});
  append_history(folder / "run-1" / "history.jsonl", {late, old});
  const auto history = load_history({folder}, {});
  ASSERT_EQ(history.size(), 1U);
  ASSERT_EQ(history[0].points.size(), 2U);
  EXPECT_EQ(history[0].points[0].commit, "a");
  std::filesystem::remove_all(folder / "run-1");
  std::filesystem::remove_all(folder / "run-2");
  EXPECT_THROW(load_history({folder}, {}), BadData);
}

TEST_F(HistoryFile, ABadLineIsNamed) {
  write_file(file,
             "{\"commit\": \"a\", \"metric\": \"m\", \"value\": 1}\n{\"commit\": \"b\", \"metric\": \"m\", \"value\": "
             "null}\n");
  try {
    load_history({file}, {"", "", "", "", "m"});
    FAIL() << "accepted";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("line 2"));
  }
}

// As ctest 3.25 writes it.
TEST_F(HistoryFile, MeasurementsOfARunAreCollected) {
  std::filesystem::create_directories(folder / "20260102-0304");
  write_file(folder / "TAG", "20260102-0304\nNightly\nNightly\n");
  write_file(folder / "20260102-0304" / "Test.xml",
             R"(<?xml version="1.0" encoding="UTF-8"?>
<Site BuildName="Linux-gcc" BuildStamp="20260102-0304-Nightly" Name="lab" Generator="ctest-3.25.1"><Testing>
<StartTestTime>1767323040</StartTestTime><TestList><Test>./golden.x</Test></TestList>
<Test Status="passed"><Name>golden.x</Name><Results>
<NamedMeasurement type="numeric/double" name="force_rms_N"><Value>0.125</Value></NamedMeasurement>
<NamedMeasurement type="numeric/double" name="Execution Time"><Value>0.01</Value></NamedMeasurement>
<NamedMeasurement type="numeric/double" name="Processors"><Value>1</Value></NamedMeasurement>
<NamedMeasurement type="numeric/double" name="force_p99_N"><Value>nan</Value></NamedMeasurement>
<NamedMeasurement type="numeric/double" name="force_max_N"><Value></Value></NamedMeasurement>
<NamedMeasurement type="text/string" name="golden_hash"><Value>1</Value></NamedMeasurement>
</Results></Test></Testing></Site>)");
  const CollectedRun run = collect_ctest(folder, "abc");
  const auto& collected = run.series;
  ASSERT_EQ(collected.size(), 1U);
  EXPECT_EQ(collected[0].key, (SeriesKey{"lab", "Linux-gcc", "Nightly", "golden.x", "force_rms_N"}));
  EXPECT_EQ(collected[0].points[0].value, 0.125);
  EXPECT_EQ(collected[0].points[0].time, "2026-01-02T03:04:00Z");
  EXPECT_THAT(run.not_numbers, ElementsAre("golden.x: force_p99_N = nan", "golden.x: force_max_N = "));
  try {
    collect_ctest("build/nowhere/Testing", "abc");
    FAIL() << "there is no run";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("ctest --test-dir build/nowhere -T Test"));
  }
}

TEST(Gates, HoldTheNewestValueInBothDirections) {
  const std::vector<double> values{1.0, 1.0, 1.2};
  EXPECT_FALSE(judged(values).failed());
  EXPECT_FALSE(judged(values, {.maximum = 1.3, .minimum = 1.0, .most_rise = 0.25}).failed());
  EXPECT_EQ(judged(values, {.maximum = 1.1, .minimum = 1.3, .most_rise = 0.1}).findings.size(), 3U);
  EXPECT_TRUE(judged({}, {.maximum = 1.0}).failed());
  EXPECT_TRUE(judged({1.0}, {.most_rise = 1.0}).failed());
}

TEST(Gates, AFallOfANegativeValueIsAFall) {
  const std::vector<double> values{-1.0, -1.0, -1.5};
  EXPECT_FALSE(judged(values, {.most_rise = 0.1}).failed());
  EXPECT_TRUE(judged(values, {.most_fall = 0.1}).failed());
  EXPECT_TRUE(judged({-1.0, -1.0, -0.5}, {.most_rise = 0.1}).failed());
}

TEST(Gates, RoundingAfterZerosIsNoRise) {
  EXPECT_FALSE(judged({0.0, 0.0, 0.0, 1e-15}, {.most_rise = 0.02}).failed());
  EXPECT_TRUE(judged({0.0, 0.0, 0.0, 1e-3}, {.most_rise = 0.02}).failed());
}

TEST(Judgement, AStepFailsUntilItIsAcceptedOrOver) {
  auto values = noisy(80, 0.01, 3);
  for (std::size_t i = 60; i < values.size(); ++i) values[i] += 0.2;
  const auto verdict = judged(values);
  EXPECT_TRUE(verdict.failed());
  ASSERT_EQ(verdict.findings.size(), 1U);
  EXPECT_THAT(verdict.findings[0].sentence, HasSubstr("c59..c60"));
  EXPECT_FALSE(judged(values, {.worse = Worse::down}).failed());
  EXPECT_TRUE(judged(values, {.worse = Worse::up}).failed());
  EXPECT_FALSE(judged(values, {.smallest_relative = 0.3}).failed());
  EXPECT_FALSE(judged(values, {.accepted = {{"c60", "a better algorithm"}}}).failed());
  EXPECT_TRUE(judged(values, {.accepted = {{"c12", "another"}}}).failed());
  for (std::size_t i = 70; i < values.size(); ++i) values[i] -= 0.2;
  EXPECT_FALSE(judged(values, {.worse = Worse::up}).failed()) << "over since then";
}

TEST(Judgement, ADriftFails) {
  auto values = noisy(60, 0.001, 6);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.0005 * static_cast<double>(i);
  const auto verdict = judged(values);
  ASSERT_EQ(verdict.findings.size(), 1U);
  EXPECT_THAT(verdict.findings[0].sentence, HasSubstr("drift"));
  EXPECT_TRUE(verdict.failed());
}

TEST_F(HistoryFile, LimitsAreReadAndTheFirstThatMatchesCounts) {
  write_file(file, R"({"schema": "touchstone-history/1", "false_alarms_per_year": 0.005, "limits": [
    {"metric": "force_rms_N", "test": "golden.*", "worse": "up", "max": 0.1,
     "accepted": [{"commit": "abc", "reason": "new algorithm"}]},
    {"metric": "*", "smallest_relative": 0.1}]})");
  const auto limits = load_history_limits(file);
  EXPECT_EQ(limits.false_alarms_per_year, 0.005);
  EXPECT_EQ(limits.of({"", "", "", "golden.x", "force_rms_N"}).maximum, 0.1);
  EXPECT_EQ(limits.of({"", "", "", "bench", "force_rms_N"}).smallest_relative, 0.1);
  write_file(file, R"({"schema": "touchstone-history/1", "limits": [{"metric": "m", "worse": "upwards"}]})");
  EXPECT_THROW(load_history_limits(file), BadData);
}

TEST(HistoryPicture, EachLevelIsALineOfItsOwnAndHorizontal) {
  auto values = noisy(80, 0.01, 3);
  for (std::size_t i = 60; i < values.size(); ++i) values[i] += 0.2;
  const JudgedSeries one{series_of(values), judged(values)};
  const auto plot = history_plot(one);
  ASSERT_EQ(plot.panels.size(), 1U);
  ASSERT_EQ(plot.panels[0].lines.size(), 3U);
  for (std::size_t i = 1; i < 3; ++i) {
    const auto& points = plot.panels[0].lines[i].points;
    ASSERT_EQ(points.size(), 2U);
    EXPECT_EQ(points[0].second, points[1].second);
    EXPECT_LT(points[0].first, points[1].first);
  }
  const auto page = history_page({one}, "A <title>");
  EXPECT_THAT(page, HasSubstr("A &lt;title&gt;"));
  EXPECT_THAT(page, HasSubstr("class=\"failed\""));
  EXPECT_EQ(page.find("http"), std::string::npos) << "nothing is fetched";
  EXPECT_TRUE(history_json({one})["failed"].get<bool>());
}

}  // namespace
}  // namespace touchstone::dashboard
