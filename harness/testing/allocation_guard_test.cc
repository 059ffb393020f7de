#include "harness/testing/allocation_guard.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

namespace touchstone::testing {
namespace {

struct alignas(64) Wide {
  double x[8];
};

TEST(AllocationGuard, CountsEveryFormOnThisThreadOnly) {
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

}  // namespace
}  // namespace touchstone::testing
