#include <gtest/gtest.h>

#include <array>

#include "simulated_sessions_for_test.h"

namespace touchstone::acquisition {
namespace {

// Refused without a cause: at most 1 %.
TEST(SessionCheckNightly, TwoHundredUndisturbedSessionsPassAndAreRight) {
  const Outcomes all = acquire_all(9001, 200, std::array{Disturbance::none});
  EXPECT_LE(all.refused, 2);
  EXPECT_EQ(all.wrong, 0);
}

TEST(SessionCheckNightly, TwoHundredDisturbedSessionsAreRefusedOrRight) {
  EXPECT_EQ(acquire_all(9501, 200, all_disturbances).wrong, 0);
}

// A scan that is off by as much as optical scanners state, with an error that is correlated along the surface.
TEST(SessionCheckNightly, TheScansErrorIsNoMoveAndHidesNone) {
  const Outcomes undisturbed = acquire_all(9801, 100, std::array{Disturbance::none}, 0.2e-3);
  EXPECT_LE(undisturbed.refused, 2);
  EXPECT_EQ(undisturbed.wrong, 0);
  EXPECT_EQ(acquire_all(9901, 100, std::array{Disturbance::moved_object}, 0.2e-3).wrong, 0);
}

}  // namespace
}  // namespace touchstone::acquisition
