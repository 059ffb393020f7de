#include "case_engine.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <mutex>
#include <new>
#include <thread>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/base/progress.h"

namespace touchstone::runs {
namespace {

using Clock = std::chrono::steady_clock;

// What a kill can cost, against what a commit costs: some ten milliseconds on a disk.
constexpr std::chrono::milliseconds between_commits{1000};
constexpr std::size_t most_waiting = 4096;

// Takes rows from all threads and commits them now and then.
class Collector {
 public:
  Collector(const CaseJob& job, CaseStore& store, std::uint64_t total)
      : store_(&store), progress_(job.what, total * job.parts) {}

  void take(CaseRow row, std::uint64_t parts_left) {
    const std::lock_guard lock(mutex_);
    ++ran_;
    failed_ += row.error.empty() ? 0 : 1;
    waiting_.push_back(std::move(row));
    progress_.update(parts_ += parts_left);
    if (!full_ && (waiting_.size() >= most_waiting || Clock::now() - committed_ >= between_commits)) try_to_commit();
  }
  // The store takes no more rows: further cases would be lost.
  [[nodiscard]] bool full() const { return full_; }
  void part_done() {
    const std::lock_guard lock(mutex_);
    progress_.update(++parts_);
  }
  void finish(CaseTally& tally) {
    const std::lock_guard lock(mutex_);
    try {
      commit();  // what did not fit may fit now
    } catch (const BadData& error) {
      throw BadData(
          fmt::format("{}; {} cases that ran are not in it. What was stored before is: make room and run again",
                      error.what(), waiting_.size()));
    }
    tally.ran = ran_;
    tally.failed = failed_;
  }

 private:
  void commit() {
    store_->add(waiting_);
    waiting_.clear();
    committed_ = Clock::now();
  }

  // No exception: this is called on all threads, in the middle of other cases.
  void try_to_commit() {
    try {
      commit();
    } catch (const BadData&) {
      full_ = true;
    }
  }

  std::mutex mutex_;
  std::atomic<bool> full_ = false;
  CaseStore* store_;
  Progress progress_;
  std::vector<CaseRow> waiting_;
  Clock::time_point committed_ = Clock::now();
  std::uint64_t parts_ = 0;
  std::uint64_t ran_ = 0;
  std::uint64_t failed_ = 0;
};

void run_one(const CaseJob& job, std::uint64_t number, Collector& collector) {
  CaseRow row;
  row.number = number;
  std::uint64_t parts_left = job.parts;
  try {
    job.run(row, [&] {
      if (parts_left == 0) return;
      --parts_left;
      collector.part_done();
    });
  } catch (const Stopped&) {
    return;  // as if it had not begun
  } catch (const std::bad_alloc&) {
    row.error = "out of memory";
  } catch (const std::exception& error) {
    row.error = error.what();
    if (row.error.empty()) row.error = "failed without saying why";
  }
  try {
    collector.take(std::move(row), parts_left);
  } catch (const Stopped&) {  // of the progress: the row is taken
  }
}

// As the kernel estimates what can be had without swapping; 0 where it does not say.
std::uint64_t free_memory() {
  std::ifstream file("/proc/meminfo");
  for (std::string name, unit; file >> name;) {
    std::uint64_t kilobytes = 0;
    if (name == "MemAvailable:" && file >> kilobytes) return 1024 * kilobytes;
    std::getline(file, unit);
  }
  return 0;
}

unsigned threads_for(const CaseJob& job, unsigned wanted) {
  const unsigned threads = wanted == 0 ? std::max(1U, std::thread::hardware_concurrency()) : wanted;
  const std::uint64_t memory = free_memory();
  if (job.alone || job.bytes == 0 || memory == 0) return threads;
  return static_cast<unsigned>(std::clamp<std::uint64_t>(memory / job.bytes, 1, threads));
}

}  // namespace

std::vector<std::uint64_t> cases_left(const std::vector<std::uint64_t>& done, std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint64_t> open;
  auto at = std::ranges::lower_bound(done, first);
  for (std::uint64_t number = first; number < last; ++number) {
    if (at != done.end() && *at == number) {
      ++at;
    } else {
      open.push_back(number);
    }
  }
  return open;
}

CaseTally run_cases(const CaseJob& job, CaseStore& store, CaseShard shard, unsigned threads,
                    const std::atomic<bool>& stop) {
  const std::uint64_t first = shard.first(job.cases);
  const std::uint64_t last = shard.last(job.cases);
  const auto open = cases_left(store.done(), first, last);
  CaseTally tally{last - first - open.size(), 0, 0, false};
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads_for(job, threads));
  Collector collector(job, store, open.size());
  // One case is thousands of steps: each may go to another thread. A thread works through neighbours, which share.
  const auto run = [&](std::size_t i) {
    // Isolated: a thread that waits for the parts of a structure that it is making must not begin another case, which
    // could want that very structure.
    if (!stop && !collector.full()) tbb::this_task_arena::isolate([&] { run_one(job, open[i], collector); });
  };
  in_parallel(open.size(), run, job.alone ? std::max<std::size_t>(1, open.size()) : 1);
  collector.finish(tally);
  tally.stopped = tally.ran < open.size();
  return tally;
}

}  // namespace touchstone::runs
