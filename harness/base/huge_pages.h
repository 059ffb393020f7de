// Memory for large arrays in pages of 2 MB: what is read here and there in it misses the processor's table of pages
// less often, and it is handed over by the system in fewer pieces. A wish: where the system does not grant it, or off
// Linux, nothing changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace touchstone {

// The whole pages of 2 MB between `begin` and `bytes` on; off Linux nothing.
inline void ask_for_huge_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) noexcept {
#ifdef __linux__
  constexpr std::size_t page = std::size_t{2} << 20;
  const std::size_t skip = (page - reinterpret_cast<std::uintptr_t>(begin) % page) % page;
  if (bytes < skip + page) return;
  madvise(static_cast<char*>(begin) + skip, (bytes - skip) / page * page, MADV_HUGEPAGE);
#endif
}

// As vector::reserve(), before the elements are written.
template <class T>
void reserve_in_huge_pages(std::vector<T>& array, std::size_t count) {
  array.reserve(count);
  ask_for_huge_pages(array.data(), array.capacity() * sizeof(T));
}

}  // namespace touchstone
