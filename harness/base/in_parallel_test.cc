#include "harness/base/in_parallel.h"

#include <gtest/gtest.h>

#include <mutex>
#include <stdexcept>
#include <vector>

namespace touchstone {
namespace {

// What the thread sanitizer would object to, were the order of oneTBB not told to it: each piece reads what was written
// before, and what it wrote is read after.
TEST(InParallel, EachIndexOnceAndInOrderWithTheCaller) {
  for (const std::size_t count : {0U, 1U, 7U, 100000U}) {
    for (const std::size_t piece : {1U, 3U, 8192U}) {
      std::vector<std::size_t> before(count, 5);
      std::vector<std::size_t> after(count, 0);
      in_parallel(
          count, [&](std::size_t i) { after[i] += before[i] + i; }, piece);
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(after[i], 5 + i) << count << " in pieces of " << piece;
    }
  }
}

// A thread that waits for its pieces must not take up work that wants the lock which it holds.
TEST(InParallel, WaitsWithoutTakingUpOtherWork) {
  std::mutex mutex;
  std::size_t sum = 0;
  const auto outer = [&](std::size_t /*i*/) {
    const std::lock_guard lock(mutex);
    std::vector<std::size_t> parts(64);
    in_parallel(
        parts.size(), [&](std::size_t k) { parts[k] = k; }, 1);
    for (const std::size_t part : parts) sum += part;
  };
  in_parallel(200, outer, 1);
  EXPECT_EQ(sum, 200U * (63U * 64U / 2U));
}

TEST(InParallel, ThrowsWhatAPieceThrew) {
  const auto work = [](std::size_t i) {
    if (i == 777) throw std::runtime_error("777");
  };
  EXPECT_THROW(in_parallel(1000, work, 1), std::runtime_error);
}

// As a full disk has it: each call fails, on every thread, inside loops that are isolated from one another.
TEST(InParallel, FailuresOnAllThreadsAtOnceEndTheLoopInOneException) {
  const auto inner = [](std::size_t i) {
    if (i % 3 == 0) throw std::runtime_error("full");
  };
  const auto outer = [&](std::size_t /*i*/) { in_parallel(30, inner, 1); };
  for (int round = 0; round < 200; ++round) EXPECT_THROW(in_parallel(50, outer, 1), std::runtime_error);
}

}  // namespace
}  // namespace touchstone
