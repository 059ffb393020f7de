#include <gtest/gtest.h>

#include <vector>

#include "fuzz/read_structured_cdash.h"
#include "harness/base/random.h"

namespace touchstone::dashboard {
namespace {

TEST(StructuredCdash, IsReadUndamagedAndSometimesDamaged) {
  EXPECT_EQ(fuzz::read_structured_cdash(nullptr, 0), 4U);
  Random random(1);
  int read = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    std::vector<std::uint8_t> bytes(2 + random.below(40));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    read += fuzz::read_structured_cdash(bytes.data(), bytes.size()) > 0 ? 1 : 0;
  }
  EXPECT_GT(read, 10) << "the damage hides what lies behind the first checks";
  EXPECT_LT(read, 950) << "nothing is damaged";
}

}  // namespace
}  // namespace touchstone::dashboard
