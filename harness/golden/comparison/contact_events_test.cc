#include "harness/golden/comparison/contact_events.h"

#include <gtest/gtest.h>

#include "harness/golden/comparison/compare.h"

namespace touchstone::golden {
namespace {

// A step to 1 N at row `on`, back to 0 at row `off`, at 1 kHz.
TrajectoryColumns tap(std::size_t on, std::size_t off, std::size_t rows = 100) {
  TrajectoryColumns set{"tap", {{"t", {}}, {"fz", {}}, {"contact", {}}}};
  for (std::size_t i = 0; i < rows; ++i) {
    const double touching = i >= on && i < off ? 1.0 : 0.0;
    set.columns[0].values.push_back(0.001 * static_cast<double>(i));
    set.columns[1].values.push_back(touching);
    set.columns[2].values.push_back(touching);
  }
  return set;
}

Tolerance with_tube(double tube_s) {
  auto tolerance = default_tolerance();
  tolerance.tube_s = tube_s;
  return tolerance;
}

TEST(ContactEvents, ChangesAreFound) {
  EXPECT_EQ(contact_changes(std::vector{0.0, 0.0, 1.0, 1.0, 0.0}), (std::vector<std::size_t>{2, 4}));
  EXPECT_TRUE(contact_changes(std::vector<double>{}).empty());
}

// Row by row against the sentence of the header: the rows of the golden within the tube of this row, if an event is.
TEST(TimeTube, AllowsExactlyTheRowsWithinIt) {
  constexpr std::size_t n = 40;
  std::vector<double> t_s;
  std::vector<double> contact;
  for (std::size_t i = 0; i < n; ++i) {
    t_s.push_back(static_cast<double>(i));  // whole seconds: no rounding decides what is within
    contact.push_back(i >= 10 && i < 30 ? 1.0 : 0.0);
  }
  const TimeTube tube(t_s, contact, 3.0);
  for (std::size_t row = 0; row < n; ++row) {
    const auto near = [&](std::size_t event) { return row + 3 >= event && row <= event + 3; };
    const auto expected = near(10) || near(30) ? std::pair{row - 3, std::min(row + 3, n - 1)} : std::pair{row, row};
    EXPECT_EQ(tube.rows(row), expected) << "row " << row;
  }
}

TEST(TimeTube, ShiftWithinPassesAndIsMeasured) {
  const auto result = compare(tap(30, 60), tap(32, 59), with_tube(0.0025));
  EXPECT_EQ(result.verdict, Verdict::equal);
  EXPECT_NEAR(result.events.max_shift_s, 0.002, 1e-12);
  EXPECT_NEAR(result.events.mean_shift_s, 0.0005, 1e-12);
}

TEST(TimeTube, WithoutItTheSameShiftFails) {
  EXPECT_EQ(compare(tap(30, 60), tap(31, 60), with_tube(0.0)).verdict, Verdict::worse);
}

TEST(TimeTube, ShiftBeyondFails) {
  EXPECT_EQ(compare(tap(30, 60), tap(34, 60), with_tube(0.0025)).verdict, Verdict::worse);
}

TEST(TimeTube, AnEventMoreOrLessFails) {
  auto bounced = tap(30, 60);
  bounced.columns[2].values[31] = 0.0;
  EXPECT_EQ(compare(tap(30, 60), bounced, with_tube(0.005)).verdict, Verdict::worse);
  EXPECT_EQ(compare(tap(30, 60), tap(100, 100), with_tube(0.005)).verdict, Verdict::worse);
}

TEST(TimeTube, ForcesAwayFromEventsAreStillHeldSampleBySample) {
  auto obtained = tap(30, 60);
  obtained.columns[1].values[45] = 1.01;
  EXPECT_EQ(compare(tap(30, 60), obtained, with_tube(0.005)).verdict, Verdict::worse);
}

TEST(TimeTube, ForceOutsideTheGoldensBandFailsNearAnEventToo) {
  auto obtained = tap(30, 60);
  obtained.columns[1].values[30] = 1.5;
  EXPECT_EQ(compare(tap(30, 60), obtained, with_tube(0.005)).verdict, Verdict::worse);
}

// What the golden does farther from the event than the tube is no excuse.
TEST(TimeTube, TheBandHasTheRowsOfTheTubeAlone) {
  for (const std::size_t spike : {20U, 40U, 50U, 70U}) {
    auto golden = tap(30, 95);
    golden.columns[1].values[spike] = 2.0;
    auto obtained = golden;
    obtained.columns[1].values[30] = 1.5;
    EXPECT_EQ(compare(golden, obtained, with_tube(0.005)).verdict, Verdict::worse) << spike;
  }
}

// The error is what is missing to the band, on either side.
TEST(TimeTube, ForceWithinToleranceOfTheGoldensBandPasses) {
  for (const double force : {-5e-7, 1.0 + 5e-7}) {
    auto obtained = tap(30, 60);
    obtained.columns[1].values[30] = force;
    EXPECT_EQ(compare(tap(30, 60), obtained, with_tube(0.005)).verdict, Verdict::equal) << force;
    obtained.columns[1].values[30] = force < 0.5 ? -1e-5 : 1.0 + 1e-5;
    EXPECT_EQ(compare(tap(30, 60), obtained, with_tube(0.005)).verdict, Verdict::worse) << force;
  }
}

TEST(TimeTube, NeedsTheContactColumn) {
  auto golden = tap(30, 60);
  golden.columns.pop_back();
  EXPECT_EQ(compare(golden, golden, with_tube(0.005)).verdict, Verdict::missing);
}

}  // namespace
}  // namespace touchstone::golden
