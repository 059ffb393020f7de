#include <gtest/gtest.h>

#include "hand_held_sessions_for_test.h"
#include "tap_session_for_test.h"

namespace touchstone::acquisition {
namespace {

TEST(TapAlignmentNightly, FindsOffsetAndSkewOverAHundredSeeds) { check_alignment_over_seeds(100); }

// 190 of 200 are expected within a 95 % interval; 181 to 198 happen in 999 of 1000 such draws.
TEST(TapAlignmentNightly, IntervalsCoverOverTwoHundredSessions) {
  const SessionTally tally = align_sessions(5001, 200, {});
  EXPECT_LE(tally.refused, 4);
  for (const int covered : {tally.covered_middle, tally.covered_start, tally.covered_end}) {
    EXPECT_GE(covered, 181 - tally.refused);
    EXPECT_LE(covered, 198);
  }
}

}  // namespace
}  // namespace touchstone::acquisition
