// Runs the cases of a sweep that are not done yet on the cores of this machine (oneTBB) and keeps the results.
#pragma once

#include <atomic>
#include <cstdint>

#include "apps/sweep/store.h"

namespace touchstone::apps {

// Part `index` (1 to `count`) of the cases: consecutive numbers, so that cases which share a surface stay together.
struct SweepShard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
  [[nodiscard]] std::uint64_t first(std::uint64_t cases) const noexcept;
  [[nodiscard]] std::uint64_t last(std::uint64_t cases) const noexcept;  // behind the last
};

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
