#include "harness/testing/allocation_guard.h"

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

#include "harness/base/thread_sanitizer.h"

namespace {

thread_local std::uint64_t allocations = 0;

}  // namespace

namespace touchstone::testing {

std::uint64_t allocations_on_this_thread() noexcept { return allocations; }

bool allocations_are_counted() noexcept {
#ifdef TOUCHSTONE_THREAD_SANITIZER
  return false;
#else
  return true;
#endif
}

}  // namespace touchstone::testing

#ifndef TOUCHSTONE_THREAD_SANITIZER
namespace {

// A sanitizer has its own malloc, which must stay; C code's allocations are then not seen.
#if defined(__SANITIZE_ADDRESS__)
#define TOUCHSTONE_COUNTS_MALLOC 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer)
#define TOUCHSTONE_COUNTS_MALLOC 0
#endif
#endif
#if !defined(TOUCHSTONE_COUNTS_MALLOC) && defined(__GLIBC__)
#define TOUCHSTONE_COUNTS_MALLOC 1
#endif

void* counted(std::size_t size, std::size_t alignment) noexcept {
#if !TOUCHSTONE_COUNTS_MALLOC
  ++allocations;
#endif
  if (size == 0) size = 1;
  if (alignment <= alignof(std::max_align_t)) return std::malloc(size);
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* counted_or_throw(std::size_t size, std::size_t alignment) {
  void* const memory = counted(size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

std::size_t number(std::align_val_t alignment) { return static_cast<std::size_t>(alignment); }

}  // namespace

#if TOUCHSTONE_COUNTS_MALLOC
// Those of this program and of the libraries that it loads, plug-ins too: glibc's own, counted on the way.
extern "C" {
// NOLINTBEGIN(clang-diagnostic-reserved-identifier): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t nmemb, std::size_t size);
void* __libc_realloc(void* ptr, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(clang-diagnostic-reserved-identifier)

void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t nmemb, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(nmemb, size);
}
void* realloc(void* ptr, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(ptr, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memptr, std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  *memptr = __libc_memalign(alignment, size);
  return *memptr == nullptr && size != 0 ? ENOMEM : 0;
}
}
#endif

// Every form, so that none of the library's frees what another one allocated.
void* operator new(std::size_t size) { return counted_or_throw(size, 1); }
void* operator new(std::size_t size, std::align_val_t alignment) { return counted_or_throw(size, number(alignment)); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return counted(size, 1); }
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return counted(size, number(alignment));
}
void* operator new[](std::size_t size) { return counted_or_throw(size, 1); }
void* operator new[](std::size_t size, std::align_val_t alignment) { return counted_or_throw(size, number(alignment)); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return counted(size, 1); }
void* operator new[](std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return counted(size, number(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
#endif
