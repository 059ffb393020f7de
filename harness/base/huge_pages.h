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
  constexpr std::size_t kPage = std::size_t{2} << 20;
  auto* const begin = reinterpret_cast<char*>(array.data());
  const std::size_t skip = (kPage - reinterpret_cast<std::uintptr_t>(begin) % kPage) % kPage;
  const std::size_t bytes = array.capacity() * sizeof(T);
  if (bytes < skip + kPage) return;
  madvise(begin + skip, (bytes - skip) / kPage * kPage, MADV_HUGEPAGE);
#endif
}

}  // namespace touchstone
