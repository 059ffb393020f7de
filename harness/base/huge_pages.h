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

// As vector::reserve(), before the elements are written.
template <class T>
void reserve_in_huge_pages(std::vector<T>& array, std::size_t count) {
  array.reserve(count);
#ifdef __linux__
  constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20;
  const auto begin = reinterpret_cast<std::uintptr_t>(array.data());
  const std::uintptr_t first = (begin + kPage - 1) & ~(kPage - 1);
  const std::uintptr_t last = (begin + array.capacity() * sizeof(T)) & ~(kPage - 1);
  if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
}

}  // namespace touchstone
