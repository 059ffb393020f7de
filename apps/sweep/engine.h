// Runs the cases of a sweep that are not done yet on the cores of this machine (oneTBB) and keeps the results.
#pragma once

#include <atomic>
#include <cstdint>

#include "apps/sweep/shard.h"
#include "apps/sweep/store.h"

namespace touchstone::apps {

struct SweepTally {
  std::uint64_t before = 0;  // were done already
  std::uint64_t ran = 0;     // now, failed ones included
  std::uint64_t failed = 0;  // now
  bool stopped = false;
};

// `threads` 0: as many as there are cores. Stops soon after `stop` becomes true; what ran is kept. Progress with rate
// and time left on stderr where that is a terminal.
SweepTally run_sweep(const SweepDesign& design, SweepStore& store, SweepShard shard, unsigned threads,
                     const std::atomic<bool>& stop);

}  // namespace touchstone::apps
