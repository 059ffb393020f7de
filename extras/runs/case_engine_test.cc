#include "case_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/base/progress.h"

namespace touchstone::runs {
namespace {

using testing::ElementsAre;

const std::atomic<bool> never = false;
const CaseTable table{"squares", 200, {{"square"}}};

// Squares; every hundredth fails.
CaseJob squares() {
  CaseJob job;
  job.what = "squares";
  job.cases = table.cases;
  job.run = [](CaseRow& row, const PartDone&) {
    row.values = {static_cast<double>(row.number * row.number)};
    if (row.number % 100 == 99) throw BadData("ninety-nine");
  };
  return job;
}

TEST(CaseEngine, KeepsEveryCaseOnceInWhateverOrderItRuns) {
  std::string hash;
  for (const unsigned threads : {1U, 4U}) {
    CaseStore store(CaseStore::in_memory, table);
    store.start_run({});
    EXPECT_EQ(run_cases(squares(), store, {2, 4}, threads, never).ran, 50U);
    const CaseTally tally = run_cases(squares(), store, {}, threads, never);
    EXPECT_EQ(tally.before, 50U);
    EXPECT_EQ(tally.ran, 150U);
    EXPECT_EQ(tally.failed, 1U);  // the other was among the first fifty
    EXPECT_FALSE(tally.stopped);
    for (const CaseRow& row : store.rows(0, 200)) {
      EXPECT_EQ(as_number(row.values[0]), static_cast<double>(row.number * row.number));
      EXPECT_EQ(row.error, row.number % 100 == 99 ? "ninety-nine" : "");
    }
    EXPECT_EQ(store.done().size(), 200U);
    if (hash.empty()) hash = store.content_hash();
    EXPECT_EQ(store.content_hash(), hash);
  }
}

TEST(CaseEngine, StopsSoonAndGoesOn) {
  CaseStore store(CaseStore::in_memory, table);
  store.start_run({});
  std::atomic<bool> stop = false;
  CaseJob job = squares();
  job.run = [&](CaseRow& row, const PartDone&) { stop = row.number == 20; };
  const CaseTally tally = run_cases(job, store, {}, 1, stop);
  EXPECT_TRUE(tally.stopped);
  EXPECT_LT(tally.ran, 200U);
  EXPECT_EQ(run_cases(squares(), store, {}, 1, never).ran, 200U - tally.ran);
}

// A long case ends within where it is asked to, and is run again as if it had not begun.
TEST(CaseEngine, ACaseThatIsStoppedWithinIsNoRow) {
  CaseStore store(CaseStore::in_memory, table);
  store.start_run({});
  std::atomic<bool> stop = false;
  CaseJob job = squares();
  job.run = [&](CaseRow& row, const PartDone&) {
    if (row.number == 20) {
      stop = true;
      ask_to_stop();
    }
    stop_if_asked();
    row.values = {1.0};
  };
  const CaseTally tally = run_cases(job, store, {}, 1, stop);
  allow_work();
  EXPECT_TRUE(tally.stopped);
  EXPECT_EQ(tally.failed, 0U);
  for (const CaseRow& row : store.rows(0, 200)) EXPECT_NE(row.number, 20U);
  EXPECT_EQ(run_cases(squares(), store, {}, 1, never).ran, 200U - tally.ran);
}

TEST(CaseEngine, OneAfterTheOtherWithAllThreadsInside) {
  std::atomic<int> running = 0;
  CaseJob job = squares();
  job.alone = true;
  job.parts = 3;
  std::mutex mutex;
  std::set<std::thread::id> inside;
  job.run = [&](CaseRow& row, const PartDone& part_done) {
    EXPECT_EQ(++running, 1);
    in_parallel(
        8,
        [&](std::size_t) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
          const std::lock_guard lock(mutex);
          inside.insert(std::this_thread::get_id());
        },
        1);
    for (int part = 0; part < 5; ++part) part_done();  // more than it has: not counted
    row.values = {1.0};
    --running;
  };
  CaseStore store(CaseStore::in_memory, table);
  store.start_run({});
  EXPECT_EQ(run_cases(job, store, {1, 20}, 2, never).ran, 10U);
  EXPECT_LE(inside.size(), 2U);
}

TEST(CaseEngine, RunsNoMoreAtOnceThanTheMemoryHolds) {
  std::atomic<int> running = 0;
  CaseJob job = squares();
  job.bytes = std::uint64_t{1} << 60U;
  job.run = [&](CaseRow& row, const PartDone&) {
    EXPECT_EQ(++running, 1);
    row.values = {1.0};
    --running;
  };
  CaseStore store(CaseStore::in_memory, table);
  store.start_run({});
  EXPECT_EQ(run_cases(job, store, {}, 4, never).ran, 200U);
}

TEST(CaseEngine, WhatWasCommittedSurvivesKill) {
  const auto file = std::filesystem::temp_directory_path() / ("touchstone-killed-" + std::to_string(::getpid()));
  CaseJob slow = squares();
  slow.run = [](CaseRow& row, const PartDone&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    row.values = {static_cast<double>(row.number)};
  };
  const pid_t child = fork();
  if (child == 0) {
    CaseStore store(file, table);
    store.start_run({});
    run_cases(slow, store, {}, 1, never);
    _exit(0);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(2200));
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  CaseStore store(file, table);
  const auto before = store.done().size();
  store.start_run({});
  const CaseTally tally = run_cases(slow, store, {}, 4, never);
  EXPECT_EQ(tally.before, before);
  EXPECT_EQ(tally.ran, 200U - before);
  EXPECT_EQ(store.done().size(), 200U);
  std::filesystem::remove(file);
}

// No file may grow beyond this, as on a full disk, while this lives.
class SmallFiles {
 public:
  explicit SmallFiles(rlim_t bytes) : handler_(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallFiles() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }
  SmallFiles(const SmallFiles&) = delete;
  SmallFiles& operator=(const SmallFiles&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

// A file that may not grow fails as a full disk does. Many threads, many commits: what was stored before is whole, the
// error is one message, and the run goes on once there is room.
TEST(CaseEngine, AFullDiskEndsTheRunAndLosesNoStoredRow) {
  const auto file = std::filesystem::temp_directory_path() / ("touchstone-full-" + std::to_string(::getpid()));
  const CaseTable many{"squares", 40000, {{"square"}}};
  CaseJob job = squares();
  job.cases = many.cases;
  job.run = [](CaseRow& row, const PartDone&) { row.values = {static_cast<double>(row.number * row.number)}; };
  for (int round = 0; round < 5; ++round) {
    std::filesystem::remove(file);
    {
      const SmallFiles limited(600000);
      CaseStore store(file, many);
      store.start_run({});
      try {
        run_cases(job, store, {}, 4, never);
        ADD_FAILURE() << "was stored whole";
      } catch (const BadData& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("make room and run again"));
      }
    }
    CaseStore store(file, many);
    const std::size_t before = store.done().size();
    EXPECT_GT(before, 0U);
    EXPECT_LT(before, many.cases);
    store.start_run({});
    EXPECT_EQ(run_cases(job, store, {}, 4, never).ran, many.cases - before);
  }
  std::filesystem::remove(file);
}

TEST(CasesLeft, AreThoseThatAreNotDone) {
  EXPECT_THAT(cases_left({}, 2, 4), ElementsAre(2, 3));
  EXPECT_THAT(cases_left({0, 3, 5, 9}, 2, 7), ElementsAre(2, 4, 6));
  EXPECT_TRUE(cases_left({2, 3}, 2, 4).empty());
}

}  // namespace
}  // namespace touchstone::runs
