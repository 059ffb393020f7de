// Proves that a piece of code allocates nothing: counts the calls of operator new on the calling thread while it lives.
// Link touchstone::testing_alloc, which replaces the program's operator new and delete.
//
//   AllocationGuard guard;
//   renderer->step(tip);
//   EXPECT_EQ(guard.count(), 0U);
//
// Calls of malloc that do not go through operator new are not seen.
#pragma once

#include <cstdint>

namespace touchstone::testing {

// Calls of operator new on this thread since it started.
std::uint64_t allocations_on_this_thread() noexcept;

class AllocationGuard {
 public:
  AllocationGuard() noexcept : before_(allocations_on_this_thread()) {}
  [[nodiscard]] std::uint64_t count() const noexcept { return allocations_on_this_thread() - before_; }

 private:
  std::uint64_t before_;
};

}  // namespace touchstone::testing
