#include <gtest/gtest.h>

#include <vector>

#include "fuzz/read_structured_packets.h"
#include "harness/base/random.h"

namespace touchstone::hil {
namespace {

TEST(StructuredPackets, AreReadUndamagedAndSometimesDamaged) {
  EXPECT_EQ(fuzz::read_structured_packets(nullptr, 0), 10U);
  Random random(1);
  std::size_t read = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    std::vector<std::uint8_t> bytes(4 + random.below(40));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    read += fuzz::read_structured_packets(bytes.data(), bytes.size());
  }
  EXPECT_GT(read, 50U) << "the damage hides what lies behind the first checks";
  EXPECT_LT(read, 4900U) << "nothing is damaged";
}

}  // namespace
}  // namespace touchstone::hil
