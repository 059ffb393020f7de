// The structure without damage is read; damaged ones, always the same, end in BadData or are read.
#include <gtest/gtest.h>

#include <vector>

#include "harness/base/random.h"
#include "harness/rendering/fuzz/read_structured_model.h"

namespace touchstone::rendering {
namespace {

TEST(StructuredModel, IsReadUndamagedAndSometimesDamaged) {
  const fuzz::Read whole = fuzz::read_structured_model(nullptr, 0);
  EXPECT_TRUE(whole.model);
  EXPECT_TRUE(whole.scene);
  Random random(1);
  int read = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<std::uint8_t> bytes(2 + random.below(40));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    const fuzz::Read got = fuzz::read_structured_model(bytes.data(), bytes.size());
    read += got.model || got.scene ? 1 : 0;
  }
  EXPECT_GT(read, 3) << "the damage hides what lies behind the first checks";
  EXPECT_LT(read, 290) << "nothing is damaged";
}

}  // namespace
}  // namespace touchstone::rendering
