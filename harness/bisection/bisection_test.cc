// Bisections of real git repositories made here, whose "build" copies a number: merges, broken commits, resuming,
// interrupts, several worktrees. The search itself is tested in search_test.cc.
#include "harness/bisection/bisection.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/bisection/answer_report.h"
#include "harness/bisection/measured_table.h"

namespace touchstone::bisection {
namespace {

using testing::HasSubstr;

const std::atomic<bool> never = false;

class Bisection : public testing::Test {
 protected:
  Bisection() {
    std::filesystem::remove_all(folder_);
    ensure_writable_folder(repository());
    for (const char* const name : {"GIT_AUTHOR_NAME", "GIT_COMMITTER_NAME"}) ::setenv(name, "t", 1);
    for (const char* const name : {"GIT_AUTHOR_EMAIL", "GIT_COMMITTER_EMAIL"}) ::setenv(name, "t@example.org", 1);
    for (const char* const name : {"GIT_CONFIG_GLOBAL", "GIT_CONFIG_SYSTEM"}) ::setenv(name, "/dev/null", 1);
    sh("git -c init.defaultBranch=main init -q");
  }
  ~Bisection() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path repository() const { return folder_ / "repository"; }
  void sh(const std::string& command) const {
    ASSERT_EQ(std::system(fmt::format("cd '{}' && {{ {}; }} >/dev/null 2>&1", repository().string(), command).c_str()),
              0)
        << command;
  }
  // "broken" does not build, "crash" does not run.
  std::string commit(const std::string& value, const std::string& title) {
    sh(fmt::format("echo '{}' > value && echo '{}' >> notes && git add -A && git commit -qm '{}'", value, title,
                   title));
    return GitHistory(repository()).commit("HEAD", "HEAD");
  }
  [[nodiscard]] BisectionRequest request(const std::string& good, const std::string& bad) {
    BisectionRequest own;
    own.metric = "number";
    own.good = good;
    own.bad = bad;
    own.build_command = "! grep -q broken \"$SRC/value\" && cp \"$SRC/value\" \"$BUILD/value\"";
    own.measure = [this](const BuiltCommit& built, const std::atomic<bool>&) -> std::optional<double> {
      ++measured_;
      const std::string text = read_file(built.build / "value");
      return text.starts_with("crash") ? std::nullopt : std::optional(std::stod(text));
    };
    own.out = folder_ / "out";
    own.say = [](const std::string&) {};
    return own;
  }
  [[nodiscard]] std::string state() const {
    const GitHistory history(repository());
    return history.git({"for-each-ref"}) + history.git({"worktree", "list"}) + history.git({"status", "--porcelain"});
  }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("touchstone-bisection-" + std::to_string(::getpid()));
  std::atomic<int> measured_ = 0;
};

TEST_F(Bisection, TwoFaultsAmongCommitsThatDoNotBuildOrRun) {
  const std::string good = commit("1", "start");
  for (int i = 0; i < 20; ++i) commit("1", fmt::format("plain {}", i));
  const std::string first = commit("1.5", "the first fault");
  for (int i = 0; i < 5; ++i) commit("1.5", fmt::format("later {}", i));
  commit("broken", "does not build");
  commit("crash", "does not run");
  for (int i = 0; i < 5; ++i) commit("1.5", fmt::format("fixed {}", i));
  const std::string second = commit("1.6", "the second fault");
  const std::string bad = commit("1.6", "end");
  const std::string before = state();
  for (const std::size_t parallel : {1U, 3U}) {
    std::filesystem::remove_all(folder_ / "out");
    auto wanted = request(good, bad);
    wanted.search.parallel = parallel;
    const BisectionAnswer answer = bisect(GitHistory(repository()), wanted, never);
    ASSERT_EQ(answer.steps.size(), 2U);
    EXPECT_EQ(answer.steps[0].commits, std::vector<std::string>{first});
    EXPECT_EQ(answer.steps[1].commits, std::vector<std::string>{second});
    EXPECT_TRUE(answer.steps[0].step.sure() && answer.steps[1].step.sure());
    EXPECT_NEAR(answer.steps[0].step.share, 5.0 / 6.0, 1e-9);
    const std::string text = answer_to_text(answer);
    EXPECT_THAT(text, HasSubstr("culprit: " + first + " the first fault ("));
    EXPECT_THAT(text, HasSubstr("+83.3 % of the change (+0.5); confidence: high"));
    EXPECT_THAT(answer_to_json(answer), HasSubstr("\"commit\": \"" + second + "\""));
    EXPECT_EQ(state(), before);
  }
}

TEST_F(Bisection, AFaultThatAMergeBroughtIsNamedOnItsBranch) {
  const std::string good = commit("1", "start");
  commit("1", "before the branch");
  sh("git checkout -q -b side");
  sh("git config merge.ours.driver true");
  for (int i = 0; i < 4; ++i) commit("1", fmt::format("side {}", i));
  const std::string fault = commit("2", "the fault");
  commit("2", "side end");
  sh("git checkout -q main");
  for (int i = 0; i < 6; ++i) {
    sh(fmt::format("echo {} > other && git add -A && git commit -qm 'main {}'", i, i));
  }
  sh("git merge -q --no-ff -m 'the merge' side");
  const std::string merge = GitHistory(repository()).commit("HEAD", "HEAD");
  const std::string bad = commit("2", "end");
  const BisectionAnswer answer = bisect(GitHistory(repository()), request(good, bad), never);
  ASSERT_EQ(answer.steps.size(), 1U);
  EXPECT_EQ(answer.steps[0].commits.front(), fault);
  EXPECT_EQ(answer.steps[0].merge, merge);
  EXPECT_NEAR(answer.steps[0].step.share, 1.0, 1e-9);
}

// The good end may itself lie on the branch.
TEST_F(Bisection, FromAGoodEndOnTheMergedBranch) {
  commit("1", "start");
  sh("git checkout -q -b side");
  const std::string good = commit("1", "good");
  const std::string fault = commit("2", "the fault");
  sh("git checkout -q main && echo 1 > other && git add -A && git commit -qm main");
  sh("git merge -q --no-ff -m 'the merge' side");
  const std::string bad = commit("2", "end");
  const BisectionAnswer answer = bisect(GitHistory(repository()), request(good, bad), never);
  ASSERT_EQ(answer.steps.size(), 1U);
  EXPECT_EQ(answer.steps[0].commits.front(), fault);
}

TEST_F(Bisection, AMergeThatMakesTheChangeItselfIsNamed) {
  const std::string good = commit("1", "start");
  sh("git checkout -q -b side && echo 1 > side && git add -A && git commit -qm side");
  sh("git checkout -q main && echo 1 > other && git add -A && git commit -qm other");
  sh("git merge -q --no-ff --no-commit side && echo 3 > value && git add -A && git commit -qm 'the evil merge'");
  const std::string merge = GitHistory(repository()).commit("HEAD", "HEAD");
  const std::string bad = commit("3", "end");
  const BisectionAnswer answer = bisect(GitHistory(repository()), request(good, bad), never);
  ASSERT_EQ(answer.steps.size(), 1U);
  EXPECT_EQ(answer.steps[0].commits.front(), merge);
  EXPECT_TRUE(answer.steps[0].by_merging);
}

TEST_F(Bisection, GoesOnWhereItWasStopped) {
  const std::string good = commit("1", "start");
  for (int i = 0; i < 30; ++i) commit("1", fmt::format("plain {}", i));
  const std::string fault = commit("2", "the fault");
  for (int i = 0; i < 30; ++i) commit("2", fmt::format("later {}", i));
  const std::string bad = commit("2", "end");
  const std::string before = state();
  auto stopped = request(good, bad);
  std::atomic<bool> stop = false;
  const Measure measure = stopped.measure;
  stopped.measure = [&](const BuiltCommit& built, const std::atomic<bool>& asked) {
    if (measured_ == 5) stop = true;
    return measure(built, asked);
  };
  EXPECT_THROW(bisect(GitHistory(repository()), stopped, stop), Interrupted);
  EXPECT_EQ(state(), before);
  const int first_part = measured_;
  // As a kill in the middle of a line leaves it.
  const auto table = folder_ / "out" / "measured.jsonl";
  write_file(table, read_file(table) + "{\"commit\": \"cut");
  const BisectionAnswer answer = bisect(GitHistory(repository()), request(good, bad), never);
  ASSERT_EQ(answer.steps.size(), 1U);
  EXPECT_EQ(answer.steps[0].commits.front(), fault);
  EXPECT_LE(static_cast<std::size_t>(measured_.load()), answer.builds + 2 + 1) << first_part;
  EXPECT_THROW(bisect(GitHistory(repository()), request(fault, bad), never), UsageError);  // another search
}

// The last line of a run that was killed may be cut; a whole line of another shape was written by somebody.
TEST_F(Bisection, ACutMeasurementIsDroppedAndOneOfAnotherShapeIsSaid) {
  const auto file = folder_ / "measured.jsonl";
  MeasuredTable(file, "search").add("abc", 2.0);
  const std::string sound = read_file(file);
  write_file(file, sound + R"({"commit": "de)");
  EXPECT_EQ(MeasuredTable(file, "search").find("abc").values, std::vector<double>{2.0});
  EXPECT_EQ(read_file(file), sound);
  for (const char* const line :
       {R"({"commit": 3, "value": 1})", R"({"commit": "d", "value": "1"})", R"({"commit": "d", "broken": 1})"}) {
    write_file(file, sound + line + "\n");
    try {
      const MeasuredTable table(file, "search");
      FAIL() << line;
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("measured.jsonl"), HasSubstr(line)));
    }
  }
}

TEST_F(Bisection, AnInterruptEndsTheBuildAndAllThatItStarted) {
  const std::string good = commit("1", "start");
  const std::string bad = commit("2", "end");
  const std::string before = state();
  auto slow = request(good, bad);
  const auto mark = folder_ / "alive";
  slow.build_command = fmt::format("(sleep 3; touch '{}') & wait", mark.string());
  std::atomic<bool> stop = false;
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    stop = true;
  });
  EXPECT_THROW(bisect(GitHistory(repository()), slow, stop), Interrupted);
  stopper.join();
  EXPECT_EQ(state(), before);
  std::this_thread::sleep_for(std::chrono::milliseconds(3000));
  EXPECT_FALSE(std::filesystem::exists(mark));
}

TEST_F(Bisection, AnEndThatCannotBeMeasuredIsAnError) {
  const std::string good = commit("broken", "start");
  const std::string bad = commit("2", "end");
  try {
    static_cast<void>(bisect(GitHistory(repository()), request(good, bad), never));
    FAIL() << "no error";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("the good end"));
    EXPECT_THAT(error.what(), HasSubstr("does not build"));
  }
}

TEST_F(Bisection, EndsThatAreAlikeAreSaidToBe) {
  const std::string good = commit("1", "start");
  commit("7", "there");
  const std::string bad = commit("1", "and back");
  const BisectionAnswer answer = bisect(GitHistory(repository()), request(good, bad), never);
  EXPECT_TRUE(answer.steps.empty());
  EXPECT_THAT(answer_to_text(answer), HasSubstr("the ends do not differ"));
}

}  // namespace
}  // namespace touchstone::bisection
