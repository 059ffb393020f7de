#include <gtest/gtest.h>

#include "harness/acquisition/tap_session_for_test.h"

TEST(TapAlignmentNightly, FindsOffsetAndSkewOverAHundredSeeds) {
  touchstone::acquisition::check_alignment_over_seeds(100);
}
