// Arrivals by the kernel's stamps while somebody sets the system's clock: exact numbers, no socket.
#include "drivers/stamped_udp.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::hil {
namespace {

// Packets every millisecond, read in batches of seven 2 ms after the last; the system's clock is `step_s` on from
// monotonic time 1.0 s. Returns the worst lateness, and in `early_s` the worst by which an arrival is before the truth.
double worst_lateness(double step_s, double& early_s) {
  constexpr double epoch_s = 1.7e9, wait_s = 2e-3;
  const auto real = [&](double mono_s) { return epoch_s + mono_s + (mono_s >= 1.0 ? step_s : 0.0); };
  StampedArrivals arrivals;
  double late_s = 0.0;
  early_s = 0.0;
  for (int first = 1; first < 2000; first += 7) {
    const double read_s = 1e-3 * (first + 6) + wait_s;
    arrivals.received(read_s, real(read_s));
    for (int i = first; i < first + 7; ++i) {
      const double came_s = 1e-3 * i, found_s = arrivals.arrival_s(real(came_s));
      late_s = std::max(late_s, found_s - came_s);
      early_s = std::max(early_s, came_s - found_s);
    }
  }
  return late_s;
}

TEST(StampedArrivals, AreExactWhileTheClockRuns) {
  double early_s = 0.0;
  EXPECT_LT(worst_lateness(0.0, early_s), 1e-6);
  EXPECT_LT(early_s, 1e-6);
}

TEST(StampedArrivals, AStepMakesNoneEarlyAndNoneLaterThanItsReceipt) {
  for (const double step_s : {0.002, 0.2, 3.0, 9.0, -0.002, -0.2, -3.0}) {
    double early_s = 0.0;
    EXPECT_LT(worst_lateness(step_s, early_s), 8.1e-3) << step_s;
    EXPECT_LT(early_s, 1e-6) << step_s;
  }
}

// The clock was stepped while more waited than one receipt takes: the rest has stamps of before.
TEST(StampedArrivals, StampsOfBeforeTheStepInALaterReceiptAreNotEarly) {
  StampedArrivals arrivals;
  arrivals.received(1.0, 101.0);
  EXPECT_NEAR(arrivals.arrival_s(100.9995), 0.9995, 1e-9);
  arrivals.received(1.01, 101.31);  // 0.3 s on
  EXPECT_NEAR(arrivals.arrival_s(101.001), 1.01, 1e-12);
  arrivals.received(1.0101, 101.3101);
  EXPECT_NEAR(arrivals.arrival_s(101.002), 1.0101, 1e-12);
  EXPECT_NEAR(arrivals.arrival_s(101.3100), 1.0100, 1e-6);
}

}  // namespace
}  // namespace touchstone::hil
