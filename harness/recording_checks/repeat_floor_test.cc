#include "harness/recording_checks/repeat_floor.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/recording/recording_file.h"
#include "harness/testing/shared_data.h"

namespace touchstone::recording_checks {
using recording::Recording;

namespace {

Recording strokes_late(double late_s, double noise_N, Random& random) {
  Recording r;
  r.source = "run.csv";
  for (int i = 0; i < 5000; ++i) {
    const double t = 0.01 * i - late_s;
    r.motion.t_s.push_back(0.01 * i);
    r.motion.p_W_m.emplace_back(0.05 * std::sin(0.7 * t), 0.03 * std::cos(0.31 * t), 1e-3 * std::sin(12 * t));
    r.f_W_N.emplace_back(noise_N * random.normal(), noise_N * random.normal(),
                         1.0 + std::sin(12 * t) + noise_N * random.normal());
  }
  return r;
}

TEST(RepeatFloor, IsTheNoiseOfOneAndTheStartIsTakenOut) {
  Random random(1);
  for (const double late_s : {0.0, 0.3, -0.7}) {
    const auto floor = repeat_floor(strokes_late(0.0, 0.02, random), strokes_late(late_s, 0.02, random));
    EXPECT_NEAR(floor.shift_s, late_s, 0.003);
    // Three axes; a straight line between two samples halves the noise of the second at most.
    EXPECT_LT(floor.force_N, 0.02 * std::sqrt(3.0) + 0.001);
    EXPECT_GT(floor.force_N, 0.02 * std::sqrt(2.25) - 0.001);
    EXPECT_GT(floor.within_N, floor.force_N);
    EXPECT_LT(floor.within_N, 1.05 * floor.force_N);
    EXPECT_THAT(floor.verdict(2.0 * floor.force_N), ::testing::StartsWith("2 times the floor of"));
    EXPECT_THAT(floor.verdict(0.9 * floor.force_N), ::testing::StartsWith("within the floor of"));
  }
}

TEST(RepeatFloor, SaysHowSteadyItIs) {
  Random random(3);
  const Recording one = strokes_late(0.0, 0.02, random);
  Recording two = strokes_late(0.0, 0.02, random);
  const auto even = repeat_floor(one, two);
  EXPECT_LT(even.least_steady_N, 1.2 * even.steadiest_N);
  // A tenth of the time in which the object gave way.
  for (std::size_t i = 2500; i < 3000; ++i) two.f_W_N[i].z() -= 0.5;
  const auto uneven = repeat_floor(one, two);
  EXPECT_NEAR(uneven.least_steady_N, 0.5 / std::numbers::sqrt2, 0.02);
  EXPECT_NEAR(uneven.steadiest_N, even.steadiest_N, 0.1 * even.steadiest_N);
  EXPECT_THAT(uneven.text(), ::testing::HasSubstr("by tenths of that time"));
}

// The truth leaves the noise of one recording: the floor, by chance a little more or less. A systematic error as large
// as that noise is above it.
TEST(RepeatFloor, TheTruthIsWithinItAndAnErrorAsLargeAsTheNoiseIsNot) {
  int outside = 0;
  constexpr int pairs = 200;
  for (std::uint64_t seed = 0; seed < pairs; ++seed) {
    Random random(100 + seed);
    const Recording one = strokes_late(0.0, 0.03, random);
    const auto floor = repeat_floor(one, strokes_late(0.0, 0.03, random));
    const Recording truth = strokes_late(0.0, 0.0, random);
    double squares = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i) squares += (one.f_W_N[i] - truth.f_W_N[i]).squaredNorm();
    const double error_N = std::sqrt(squares / static_cast<double>(one.size()));
    if (error_N > floor.within_N) ++outside;
    EXPECT_GT(std::hypot(error_N, 0.03), floor.within_N) << seed;
  }
  EXPECT_LE(outside, pairs / 20);
}

TEST(RepeatFloor, AnotherMotionIsRefused) {
  Random random(2);
  Recording other = strokes_late(0.0, 0.02, random);
  for (Vec3& p : other.motion.p_W_m) p = Vec3(-p.x(), p.z(), p.y());
  EXPECT_THROW(repeat_floor(strokes_late(0.0, 0.02, random), other), BadData);
}

TEST(RepeatFloor, TwoRunsOfARealRaster) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(one, "palpation/ContPalpRAL18T1.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(two, "palpation/ContPalpRAL18T2.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(elsewhere, "palpation/ContPalpTrial1.csv");
  const auto floor = repeat_floor_of_files(one, two);
  fmt::print("{}, shift {:.4g} s\n", floor.text(), floor.shift_s);
  // The first half, at equal times as recorded, is what the data set's own account gives: 0.106 N. The phantom does not
  // repeat as well between 80 s and 220 s as before and after.
  Recording first_half = recording::load_recording(one);
  const double middle_s = 0.5 * first_half.motion.t_s.back();
  const auto n = static_cast<std::size_t>(std::ranges::lower_bound(first_half.motion.t_s, middle_s) -
                                          first_half.motion.t_s.begin());
  first_half.motion.t_s.resize(n), first_half.motion.p_W_m.resize(n), first_half.motion.q_WS.resize(n);
  first_half.f_W_N.resize(n);
  EXPECT_NEAR(repeat_floor(first_half, recording::load_recording(two)).unshifted_N * std::numbers::sqrt2, 0.106,
              0.0005);
  EXPECT_NEAR(floor.unshifted_N * std::numbers::sqrt2, 0.0874, 0.0005);
  EXPECT_NEAR(floor.force_N * std::numbers::sqrt2, 0.0783, 0.0005);
  EXPECT_LT(floor.steadiest_N * std::numbers::sqrt2, 0.06);
  EXPECT_GT(floor.least_steady_N * std::numbers::sqrt2, 0.12);
  EXPECT_LT(floor.position_m * std::numbers::sqrt2, 0.3e-3);
  EXPECT_THROW(repeat_floor_of_files(one, elsewhere), BadData);
}

}  // namespace
}  // namespace touchstone::recording_checks
