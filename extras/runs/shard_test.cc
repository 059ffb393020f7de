#include "shard.h"

#include <gtest/gtest.h>

#include "harness/base/error.h"

namespace touchstone::runs {
namespace {

TEST(Shard, CoversEveryCaseOnce) {
  for (const std::uint64_t cases : {1U, 7U, 100U, 1001U}) {
    for (const std::uint64_t count : {1U, 2U, 3U, 8U}) {
      std::uint64_t next = 0;
      for (std::uint64_t k = 1; k <= count; ++k) {
        const CaseShard shard{k, count};
        EXPECT_EQ(shard.first(cases), next);
        next = shard.last(cases);
      }
      EXPECT_EQ(next, cases);
    }
  }
}

TEST(Shard, IsReadAsKOfN) {
  EXPECT_EQ(read_shard("").count, 1U);
  EXPECT_EQ(read_shard("3/8").index, 3U);
  EXPECT_EQ(read_shard("3/8").count, 8U);
  for (const char* const bad : {"3", "0/8", "9/8", "3/8x", "/8", "3/", "-1/8", "3/0", "a/b"}) {
    EXPECT_THROW(read_shard(bad), UsageError) << bad;
  }
}

}  // namespace
}  // namespace touchstone::runs
