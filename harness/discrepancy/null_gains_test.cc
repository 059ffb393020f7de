#include "harness/discrepancy/null_gains.h"

#include <gtest/gtest.h>

namespace touchstone::discrepancy {
namespace {

TEST(BarAbove, IsMeanAndDeviationsOfWhatWasGained) {
  // Mean 2, deviation 1 (n - 1 in the denominator).
  EXPECT_DOUBLE_EQ(bar_above({1.0, 2.0, 3.0}, 5.0), 7.0);
  EXPECT_EQ(bar_above({4.0}, 5.0), 0.0);
}

TEST(BarAbove, DoesNotRiseWithWhatANullWorldLoses) {
  EXPECT_DOUBLE_EQ(bar_above({1.0, 2.0, 0.0, 0.0}, 5.0), bar_above({1.0, 2.0, -140.0, -3.0}, 5.0));
  EXPECT_EQ(bar_above({-100.0, -1.0, -12.0}, 5.0), 0.0);
}

}  // namespace
}  // namespace touchstone::discrepancy
