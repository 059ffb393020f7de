#include "apps/sweep/engine.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>

#include "harness/base/in_parallel.h"
#include "harness/base/progress.h"

namespace touchstone::apps {
namespace {

using Clock = std::chrono::steady_clock;

// What a kill can cost, against what a commit costs: some ten milliseconds on a disk.
constexpr std::chrono::milliseconds between_commits{1000};
constexpr std::size_t most_waiting = 4096;

std::vector<std::uint64_t> still_to_do(const std::vector<std::uint64_t>& done, std::uint64_t first,
                                       std::uint64_t last) {
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

// Takes outcomes from all threads and commits them now and then.
class Collector {
 public:
  Collector(SweepStore& store, std::uint64_t total) : store_(&store), progress_("sweep", total) {}

  void take(SweepOutcome outcome) {
    const std::lock_guard lock(mutex_);
    ++ran_;
    failed_ += outcome.error.empty() ? 0 : 1;
    waiting_.push_back(std::move(outcome));
    progress_.update(ran_);
    if (waiting_.size() >= most_waiting || Clock::now() - committed_ >= between_commits) commit();
  }
  void finish(SweepTally& tally) {
    const std::lock_guard lock(mutex_);
    commit();
    tally.ran = ran_;
    tally.failed = failed_;
  }

 private:
  void commit() {
    store_->add(waiting_);
    waiting_.clear();
    committed_ = Clock::now();
  }

  std::mutex mutex_;
  SweepStore* store_;
  Progress progress_;
  std::vector<SweepOutcome> waiting_;
  Clock::time_point committed_ = Clock::now();
  std::uint64_t ran_ = 0;
  std::uint64_t failed_ = 0;
};

}  // namespace

SweepTally run_sweep(const SweepDesign& design, SweepStore& store, SweepShard shard, unsigned threads,
                     const std::atomic<bool>& stop) {
  const std::uint64_t first = shard.first(design.size());
  const std::uint64_t last = shard.last(design.size());
  const auto open = still_to_do(store.done(), first, last);
  SweepTally tally{last - first - open.size(), 0, 0, false};
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads == 0 ? cores : threads);
  SweepWorld world(design);
  Collector collector(store, open.size());
  // One case is thousands of steps: each may go to another thread. A thread works through neighbours, which share.
  const auto run = [&](std::size_t i) {
    // Isolated: a thread that waits for the parts of a structure that it is making must not begin another case, which
    // could want that very structure.
    if (!stop) tbb::this_task_arena::isolate([&] { collector.take(world.run(open[i])); });
  };
  in_parallel(open.size(), run, 1);
  collector.finish(tally);
  tally.stopped = tally.ran < open.size();
  return tally;
}

}  // namespace touchstone::apps
