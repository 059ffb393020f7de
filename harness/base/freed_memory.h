// For work that takes and returns the same megabytes over and over on every core.
#pragma once

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace touchstone {

// From here on, memory that is freed stays with the process: else the C library gives large blocks back to the system,
// which clears every page of them anew when they are taken again.
inline void keep_freed_memory() noexcept {
#if defined(__GLIBC__)
  constexpr int kBlocksUpTo = 32 << 20;  // the most that the C library takes for it
  mallopt(M_MMAP_THRESHOLD, kBlocksUpTo);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

}  // namespace touchstone
