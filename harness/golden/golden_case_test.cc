#include "harness/golden/golden_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/golden/acceptance.h"
#include "harness/golden/comparison/column_file.h"
#include "harness/golden/comparison/compare.h"
#include "harness/golden/golden_file.h"
#include "harness/golden/golden_summary.h"

namespace touchstone::golden {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* good_case = R"({"schema": "touchstone-golden-case/1", "name": "ball", "summary": "s",
  "surface": {"name": "sphere", "parameters": {"radius_m": 0.03}, "triangles": 100},
  "trajectory": {"name": "taps", "seed": 3, "rate_Hz": 500, "offset_m": [0, 0, 0.03]}, "scale": 2,
  "models": {"god-object": {"schema": "touchstone-model/1", "renderer": "god-object"}},
  "tolerance": {"reason": "r", "force": {"atol_N": 1e-5}}})";

class GoldenFolder : public testing::Test {
 protected:
  fs::path golden = fs::path(testing::TempDir()) /
                    (std::string("golden_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  void SetUp() override {
    fs::remove_all(golden);
    fs::create_directories(golden / "ball");
  }
  void TearDown() override { fs::remove_all(golden); }
  // The message that this case.json gets; "accepted" where it is.
  std::string message(std::string text, const std::string& what = "", const std::string& with = "") {
    if (!what.empty()) text.replace(text.find(what), what.size(), with);
    write_file(golden / "ball" / "case.json", text);
    try {
      load_case(golden / "ball");
    } catch (const BadData& error) {
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(GoldenFolder, AGoodCaseIsRead) {
  write_file(golden / "ball" / "case.json", good_case);
  const auto cases = load_cases(golden);
  ASSERT_EQ(cases.size(), 1U);
  EXPECT_EQ(cases[0].surface.triangles, 100U);
  EXPECT_EQ(cases[0].trajectory.seed, 3U);
  EXPECT_EQ(cases[0].trajectory.offset_W_m.z(), 0.03);
  EXPECT_EQ(cases[0].scale, 2.0);
  EXPECT_EQ(cases[0].speed, 1.0);
  EXPECT_EQ(cases[0].tolerance.of("force").atol, 1e-5);
  EXPECT_EQ(cases[0].expected("god-object"), golden / "ball" / "expected" / "god-object.h5");
}

TEST_F(GoldenFolder, BadCasesAreRefusedWithTheirPlace) {
  EXPECT_THAT(message(good_case, "\"ball\"", "\"cube\""), HasSubstr("/name"));
  EXPECT_THAT(message(good_case, "\"reason\": \"r\", ", ""), HasSubstr("reason"));
  EXPECT_THAT(message(good_case, "\"scale\": 2", "\"scale\": 0"), HasSubstr("/scale"));
  EXPECT_THAT(message(good_case, "\"scale\": 2", "\"size\": 2"), HasSubstr("size"));
  EXPECT_THAT(message(good_case, "\"seed\": 3", "\"seed\": 3.5"), HasSubstr("/trajectory/seed"));
  EXPECT_THAT(message(good_case, "\"god-object\": {", "\"God Object\": {"), HasSubstr("lower-case"));
  EXPECT_THAT(message(good_case, "\"name\": \"sphere\", \"parameters\": {\"radius_m\": 0.03}, \"triangles\": 100",
                      "\"mesh\": \"../x.obj\", \"unit\": \"m\""),
              HasSubstr("own folder"));
  EXPECT_EQ(message(good_case), "accepted");
}

TEST_F(GoldenFolder, AnEmptyFolderIsAnError) {
  EXPECT_THROW(load_cases(golden), BadData);
  fs::remove_all(golden / "ball");
  EXPECT_THROW(load_cases(golden), BadData);
  EXPECT_THROW(load_cases(golden / "absent"), BadData);
}

recording::RenderedTrajectory rendered() {
  recording::RenderedTrajectory run;
  for (int i = 0; i < 50; ++i) {
    run.t_s.push_back(0.001 * i);
    run.tip_W_m.emplace_back(1e-3 * i, 0.0, -1e-4 * i);
    run.contact_W_m.emplace_back(1e-3 * i, 0.0, 0.0);
    run.f_W_N.emplace_back(0.0, 0.0, 0.05 * i / 3.0);
    run.contact.push_back(i > 0 ? 1 : 0);
  }
  return run;
}

TEST_F(GoldenFolder, AGoldenFileKeepsEveryBitAndItsProvenance) {
  const auto file = golden / "ball" / "expected" / "god-object.h5";
  write_golden(file, rendered(), {{"commit", "abc"}, {"reason", "first"}});
  const auto result = compare(columns_of(rendered(), "memory"), load_columns(file), default_tolerance());
  EXPECT_EQ(result.verdict, Verdict::equal);
  EXPECT_EQ(result.drift, 0U);
  copy_golden(file, golden / "copy.h5", {{"reason", "second"}});
  EXPECT_EQ(read_provenance(golden / "copy.h5").at("commit"), "abc");
  EXPECT_EQ(read_provenance(golden / "copy.h5").at("reason"), "second");
  EXPECT_EQ(read_provenance(file).at("reason"), "first");
}

TEST_F(GoldenFolder, ADamagedGoldenIsAnErrorAndNeverAPass) {
  const auto file = golden / "god-object.h5";
  write_golden(file, rendered(), {});
  const std::string whole = read_file(file);
  write_file(file, whole.substr(0, whole.size() / 2));
  EXPECT_THROW(load_columns(file), BadData);
  int refused = 0;
  int harmless = 0;
  for (std::size_t at = whole.size() / 2; at < whole.size(); at += 37) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write_file(file, damaged);
    try {
      const auto result = compare(columns_of(rendered(), "memory"), load_columns(file), default_tolerance());
      harmless += result.verdict == Verdict::equal && result.drift == 0 ? 1 : 0;
      refused += result.verdict != Verdict::equal ? 1 : 0;
      EXPECT_TRUE(result.verdict != Verdict::equal || result.drift == 0)
          << "byte " << at << " changed a value silently";
    } catch (const BadData&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
  std::printf("damaged bytes: %d refused, %d outside of what is read\n", refused, harmless);
}

TEST(GoldenSummary, SaysWhatIsInTheRun) {
  const auto summary = summarise(rendered());
  EXPECT_EQ(summary.samples, 50U);
  EXPECT_EQ(summary.contact_samples, 49U);
  EXPECT_EQ(summary.contact_events, 1U);
  EXPECT_NEAR(summary.peak_force_N, 0.05 * 49 / 3.0, 1e-12);
  EXPECT_NEAR(summary.rms_force_N, 0.05 / 3.0 * std::sqrt(49.0 * 99.0 / 6.0), 1e-12);  // of 0, 1, ..., 49
  EXPECT_EQ(summarise({}).rms_force_N, 0.0);
  EXPECT_NEAR(summary.contact_path_m, 0.049, 1e-12);
  auto other = rendered();
  other.f_W_N[7].z() = std::nextafter(other.f_W_N[7].z(), 1.0);
  EXPECT_NE(summarise(other).sha256, summary.sha256);
  EXPECT_THAT(summaries_to_json("ball", {{"god-object", summary}}), HasSubstr("\"samples\": 50"));
}

TEST_F(GoldenFolder, OperationsAreReadBackFromTheSummary) {
  GoldenSummary counted = summarise(rendered());
  counted.operations = RunOperations{9007199254740993, 321};  // beyond what a double holds
  const fs::path file = golden / "expected.summary.json";
  EXPECT_TRUE(load_operations(file).empty()) << "no file yet";
  write_file(file, summaries_to_json("ball", {{"counted", counted}, {"plain", summarise(rendered())}}));
  const auto read = load_operations(file);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read.at("counted"), *counted.operations);
  write_file(file, R"({"models": {"counted": {"operations": 1.5, "operations_max_step": 2}}})");
  try {
    load_operations(file);
    FAIL() << "half an operation was accepted";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("/models/counted/operations"));
  }
}

TEST(GoldenOperations, AreExact) {
  const std::optional<RunOperations> golden = RunOperations{100000, 200};
  const auto verdict = [&](std::optional<RunOperations> obtained) {
    const auto change = operations_change(golden, obtained);
    return change ? change->verdict : Verdict::equal;
  };
  EXPECT_EQ(verdict(golden), Verdict::equal);
  EXPECT_EQ(verdict(RunOperations{100001, 200}), Verdict::worse);
  EXPECT_EQ(verdict(RunOperations{99999, 200}), Verdict::better);
  EXPECT_EQ(verdict(RunOperations{99999, 201}), Verdict::worse);
  EXPECT_EQ(verdict(std::nullopt), Verdict::missing);
  EXPECT_THAT(operations_change(golden, RunOperations{100500, 190})->message,
              HasSubstr("100500 (+0.5%) where the golden takes 100000, in the most expensive step 190 (-5%) for 200"));
  EXPECT_EQ(operations_change(std::nullopt, golden)->verdict, Verdict::missing);
  EXPECT_EQ(operations_change(std::nullopt, std::nullopt), std::nullopt);
  EXPECT_EQ(operations_change(RunOperations{}, RunOperations{1, 1})->verdict, Verdict::worse);
}

TEST_F(GoldenFolder, NothingIsAcceptedUnderCiOutsideGitOrFromADirtyTree) {
  const std::string run = "cd '" + golden.string() + "' && unset GIT_DIR && ";
  const auto shell = [&](const std::string& command) {
    ASSERT_EQ(std::system((run + command + " >/dev/null 2>&1").c_str()), 0) << command;
  };
  unsetenv("CI");
  setenv("GIT_CEILING_DIRECTORIES", golden.parent_path().c_str(), 1);
  EXPECT_THAT(acceptance_refused(golden).value_or(""), HasSubstr("git"));
  fs::create_directories(golden / "golden" / "ball");
  write_file(golden / "golden" / "ball" / "case.json", "{}");
  shell("git init -q . && git add -A && git -c user.name=t -c user.email=t@example.org commit -qm one");
  EXPECT_EQ(acceptance_refused(golden / "golden"), std::nullopt);
  setenv("CI", "true", 1);
  EXPECT_THAT(acceptance_refused(golden / "golden").value_or(""), HasSubstr("CI"));
  unsetenv("CI");
  fs::create_directories(golden / "golden" / "ball" / "expected");
  write_file(golden / "golden" / "ball" / "expected.summary.json", "{}");
  write_file(golden / "golden" / "ball" / "expected" / "god-object.h5", "x");
  EXPECT_EQ(acceptance_refused(golden / "golden"), std::nullopt) << "the expected results themselves may have changed";
  write_file(golden / "golden" / "ball" / "case.json", "{ }");
  EXPECT_THAT(acceptance_refused(golden / "golden").value_or(""), HasSubstr("case.json"));
  unsetenv("GIT_CEILING_DIRECTORIES");
}

}  // namespace
}  // namespace touchstone::golden
