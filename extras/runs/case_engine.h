// Runs the cases that are not done yet on the cores of this machine (oneTBB) and keeps their rows.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "case_store.h"
#include "shard.h"

namespace touchstone::runs {

// Fills the values of the row whose number is set; thread-safe, and dependent on the number alone. What it throws is
// the row's error; the values that it has filled until then stay. `part_done` is for progress within long cases.
using PartDone = std::function<void()>;
using RunCase = std::function<void(CaseRow& row, const PartDone& part_done)>;

struct CaseJob {
  std::string what;  // "sweep", for the progress
  std::uint64_t cases = 0;
  RunCase run;
  // One case after the other, each with all threads: for cases that measure times, or are parallel inside.
  bool alone = false;
  std::uint64_t parts = 1;  // how often a case calls part_done, where that is more than once
  std::uint64_t bytes = 0;  // that a running case takes; no more run at once than the free memory holds
};

struct CaseTally {
  std::uint64_t before = 0;  // were done already
  std::uint64_t ran = 0;     // now, failed ones included
  std::uint64_t failed = 0;  // now
  bool stopped = false;
};

// `threads` 0: as many as there are cores. Stops soon after `stop` becomes true; what ran is kept. Progress with rate
// and time left on stderr where that is a terminal. Throws BadData when the store cannot be written, on a full disk for
// instance: no case begins then, and what was committed stays.
CaseTally run_cases(const CaseJob& job, CaseStore& store, CaseShard shard, unsigned threads,
                    const std::atomic<bool>& stop);

// Those from `first` to before `last` that are not among `done`, both ascending.
std::vector<std::uint64_t> cases_left(const std::vector<std::uint64_t>& done, std::uint64_t first, std::uint64_t last);

}  // namespace touchstone::runs
