#include "case_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace touchstone::runs {
namespace {

using testing::HasSubstr;

// Squares of 0 to 9; 7 fails while `unlucky`.
class Command : public testing::Test {
 protected:
  Command() {
    std::filesystem::create_directories(folder_);
    command_.job.what = "squares";
    command_.job.cases = 10;
    command_.job.run = [this](CaseRow& row, const PartDone&) {
      if (unlucky_ && row.number == 7) throw BadData("seven");
      row.values = {static_cast<double>(row.number * row.number)};
    };
    command_.table = {"squares", 10, {{"square"}}, "grid", "--cases"};
    command_.words = {"squares"};
    command_.describe = [](std::uint64_t number) { return std::to_string(number * number); };
    options_.file = (folder_ / "rows.sqlite").string();
  }
  ~Command() override { std::filesystem::remove_all(folder_); }

  std::string printed(ExitStatus status) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(run_case_command(command_, options_).status, status);
    return testing::internal::GetCapturedStdout();
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("touchstone-command-" + std::to_string(::getpid()));
  CaseCommand command_;
  CaseOptions options_;
  bool unlucky_ = false;
};

TEST_F(Command, GivesTheRowsOnlyWhereAllOfThemAreThere) {
  options_.shard = "1/2";
  EXPECT_EQ(run_case_command(command_, options_).store, nullptr);
  options_.shard = "";
  const CaseOutcome whole = run_case_command(command_, options_);
  EXPECT_EQ(whole.status, ExitStatus::passed);
  ASSERT_NE(whole.store, nullptr);
  EXPECT_EQ(whole.store->rows(0, 10).size(), 10U);
}

TEST_F(Command, AFailedCaseIsReportedTheStatusSaysSoAndItCanBeRunAgain) {
  unlucky_ = true;
  EXPECT_THAT(printed(ExitStatus::failed), HasSubstr("10 of 10 cases, 1 failed"));
  unlucky_ = false;
  EXPECT_THAT(printed(ExitStatus::failed), HasSubstr("1 failed"));
  options_.retry_failed = true;
  EXPECT_THAT(printed(ExitStatus::passed), HasSubstr("10 of 10 cases, 0 failed"));
}

TEST_F(Command, MissingCasesAreNamed) {
  options_.shard = "2/2";
  const std::string half = options_.file;
  run_case_command(command_, options_);
  options_.shard = "";
  options_.file = (folder_ / "all.sqlite").string();
  options_.merge = {half};
  EXPECT_THAT(printed(ExitStatus::failed), HasSubstr("5 cases are missing: 0 1 2 3 4; run again to go on"));
}

TEST_F(Command, RowsOfAnotherBuildAreRefusedUnlessAskedFor) {
  {
    CaseStore store(options_.file, command_.table);
    store.start_run({{"version", "0.0.1"}, {"commit", "0123abcd"}});
    store.add(std::vector<CaseRow>{{3, "", {9.0}}});
  }
  try {
    run_case_command(command_, options_);
    FAIL() << "was taken";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("version 0.0.1, commit 0123abcd"));
    EXPECT_THAT(error.what(), HasSubstr("--any-build"));
  }
  EXPECT_EQ(CaseStore(options_.file, command_.table).done().size(), 1U);
  options_.any_build = true;
  EXPECT_EQ(run_case_command(command_, options_).status, ExitStatus::passed);
  // Where nothing is made of the rows they are noted only.
  options_.any_build = false;
  command_.one_build = false;
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_case_command(command_, options_).status, ExitStatus::passed);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("another build"));
}

TEST_F(Command, ADryRunListsAndTouchesNothing) {
  options_.dry_run = true;
  options_.shard = "1/5";
  EXPECT_EQ(printed(ExitStatus::passed), "0\t0\n1\t1\n");
  options_.engine = "slurm";
  EXPECT_THAT(printed(ExitStatus::passed), HasSubstr("--array=1\n"));
  EXPECT_FALSE(std::filesystem::exists(options_.file));
  options_.file = "";
  EXPECT_THROW(run_case_command(command_, options_), UsageError);
}

}  // namespace
}  // namespace touchstone::runs
