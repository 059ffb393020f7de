// Arrays reserved in large pages are arrays like others, whatever their size and however much they held before.
#include "harness/base/huge_pages.h"

#include <gtest/gtest.h>

#include <future>
#include <numeric>

#include "harness/base/freed_memory.h"

namespace touchstone {
namespace {

TEST(HugePages, ArraysKeepWhatTheyHoldAndTakeWhatTheyShall) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{1000}, std::size_t{3} << 20}) {
    std::vector<double> array{1.0, 2.0, 3.0};
    reserve_in_huge_pages(array, count);
    ASSERT_GE(array.capacity(), count);
    ASSERT_EQ(array, (std::vector<double>{1.0, 2.0, 3.0}));
    const double* const place = array.data();
    array.resize(std::max<std::size_t>(count, 3));
    EXPECT_EQ(array.data(), place) << "reserved, so not moved";
    std::iota(array.begin(), array.end(), 0.0);
    EXPECT_EQ(array.back(), static_cast<double>(array.size() - 1));
  }
}

TEST(HugePages, MemoryTakenInThemServesAllThreadsAndMoreThanWasAskedFor) {
  take_memory_in_huge_pages(std::size_t{4} << 20);
  const auto fill = [](std::size_t count) {
    std::vector<std::vector<std::size_t>> arrays(100);
    for (auto& array : arrays) {
      array.resize(count);
      std::iota(array.begin(), array.end(), count);
    }
    for (const auto& array : arrays) {
      if (array.back() != 2 * count - 1) return false;
    }
    return true;
  };
  auto other = std::async(std::launch::async, fill, 20001);
  EXPECT_TRUE(fill(30001));
  EXPECT_TRUE(other.get());
}

}  // namespace
}  // namespace touchstone
