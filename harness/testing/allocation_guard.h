// Proves that a piece of code allocates nothing: counts the calls of operator new and malloc (calloc, realloc, ...) on
// the calling thread while it lives, also those of shared libraries that the program loads. Link
// touchstone::testing_alloc, which replaces the program's operator new, operator delete and malloc.
//
//   AllocationGuard guard;
//   renderer->step(tip);
//   EXPECT_EQ(guard.count(), 0U);
//
// Where the program is built with a sanitizer, or the C library is not glibc, calls of malloc that do not go through
// operator new are not seen. With the thread sanitizer nothing is: its own operator new is what tells it of memory that
// passes between the threads of libraries.
#pragma once

#include <cstdint>

namespace touchstone::testing {

// False where a count of 0 would say nothing.
bool allocations_are_counted() noexcept;
// Allocations by this thread since it started.
std::uint64_t allocations_on_this_thread() noexcept;

class AllocationGuard {
 public:
  AllocationGuard() noexcept : before_(allocations_on_this_thread()) {}
  [[nodiscard]] std::uint64_t count() const noexcept { return allocations_on_this_thread() - before_; }

 private:
  std::uint64_t before_;
};

}  // namespace touchstone::testing
