#include "harness/testing/allocation_guard.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>

namespace touchstone::testing {
namespace {

struct alignas(64) Wide {
  double x[8];
};

TEST(AllocationGuard, CountsEveryFormOnThisThreadOnly) {
  if (!allocations_are_counted()) GTEST_SKIP() << "the thread sanitizer does not let allocations be counted";
  AllocationGuard guard;
  auto plain = std::make_unique<int>(1);
  EXPECT_EQ(guard.count(), 1U);
  auto array = std::make_unique<int[]>(10);
  auto wide = std::make_unique<Wide>();
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(wide.get()) % 64U, 0U);
  EXPECT_EQ(guard.count(), 3U);
  const std::uint64_t before = guard.count();
  int on_stack = 0;
  for (int i = 0; i < 10; ++i) on_stack += *plain;
  EXPECT_EQ(on_stack, 10);
  EXPECT_EQ(guard.count(), before);
  std::uint64_t elsewhere = 0;
  std::thread thread([&] {
    AllocationGuard other;
    const auto text = std::make_unique<char[]>(100);
    elsewhere = other.count();
  });
  thread.join();
  EXPECT_EQ(elsewhere, 1U);
}

TEST(AllocationGuard, CountsWhatCCodeAllocates) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer has its own malloc";
#endif
  // Volatile: a compiler may leave out memory that nobody uses.
  void* volatile memory = nullptr;
  const AllocationGuard guard;
  memory = std::malloc(10);
  EXPECT_EQ(guard.count(), 1U);
  memory = std::realloc(memory, 1000);
  EXPECT_EQ(guard.count(), 2U);
  std::free(memory);
  memory = std::calloc(3, 5);
  std::free(memory);
  memory = std::aligned_alloc(64, 128);
  std::free(memory);
  EXPECT_EQ(guard.count(), 4U);
}

}  // namespace
}  // namespace touchstone::testing
