// A loop over independent indices on all cores. Short loops stay on the calling thread. Results that do not depend on
// the order of the calls do not depend on the number of threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstddef>
#include <exception>

#include "harness/base/work_order.h"

namespace touchstone {

// Calls work(i) for i from 0 to count - 1; in pieces of `piece` or more. While the calling thread waits it takes up
// none but these calls, so that a lock it holds cannot meet itself. What a call throws comes out here once all have
// ended; no further ones begin then.
template <class Work>
void in_parallel(std::size_t count, Work&& work, std::size_t piece = 8192) {
  if (count <= piece) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  tbb::this_task_arena::isolate([&] {
    WorkOrder order;
    std::exception_ptr thrown;
    std::atomic<bool> failed = false;
    {
      const WorkOrder::Whole whole(order);
      // No exception passes through oneTBB: cancelling isolated tasks in mid-flight can end in a segmentation fault.
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, piece),
                        [&](const tbb::blocked_range<std::size_t>& range) noexcept {
                          const WorkOrder::Piece own(order);
                          try {
                            for (std::size_t i = range.begin(); i != range.end() && !failed; ++i) work(i);
                          } catch (...) {
                            if (!failed.exchange(true)) thrown = std::current_exception();
                          }
                        });
    }
    if (thrown) std::rethrow_exception(thrown);
  });
}

}  // namespace touchstone
