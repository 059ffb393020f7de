// How the C library gets its memory from the system, for programs in which that is a good part of the time.
#pragma once

#include <cstddef>
#include <cstdlib>

#include "harness/base/huge_pages.h"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace touchstone {

// For work that takes and returns the same megabytes over and over on every core: from here on, memory that is freed
// stays with the process: else the C library gives large blocks back to the system, which clears every page of them
// anew when they are taken again.
inline void keep_freed_memory() noexcept {
#if defined(__GLIBC__)
  constexpr int blocks_up_to = 32 << 20;  // the most that the C library takes for it
  mallopt(M_MMAP_THRESHOLD, blocks_up_to);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

// For a short run of few threads that fills some megabytes once: the next `bytes` (at most 24 MB) come from one heap
// that all threads share, in pages of 2 MB, where each page of 4 KB would be asked of the system by itself. What is not
// used takes no memory. To be called before the other threads are started; off Linux nothing changes.
inline void take_memory_in_huge_pages(std::size_t bytes) noexcept {
#if defined(__GLIBC__)
  constexpr std::size_t page = std::size_t{2} << 20;
  keep_freed_memory();
  mallopt(M_ARENA_MAX, 1);
  void* const taken = std::malloc(bytes + page);
  if (taken == nullptr) return;
  ask_for_huge_pages(taken, bytes + page);
  std::free(taken);
#else
  (void)bytes;
#endif
}

}  // namespace touchstone
