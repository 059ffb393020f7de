#include "harness/sanity/repeat_floor.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/recording/recording_file.h"
#include "harness/testing/shared_data.h"

namespace touchstone::sanity {
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

TEST(RepeatFloor, IsTheNoiseOfBothAndTheStartIsTakenOut) {
  Random random(1);
  for (const double late_s : {0.0, 0.3, -0.7}) {
    const auto floor = repeat_floor(strokes_late(0.0, 0.02, random), strokes_late(late_s, 0.02, random));
    EXPECT_NEAR(floor.shift_s, late_s, 0.003);
    // Three axes, two recordings; a straight line between two samples halves the noise of the second at most.
    EXPECT_LT(floor.force_N, 0.02 * std::sqrt(6.0) + 0.01);
    EXPECT_GT(floor.force_N, 0.02 * std::sqrt(4.5) - 0.001);
    EXPECT_THAT(floor.verdict(2.0 * floor.force_N), ::testing::StartsWith("2 times the floor of"));
    EXPECT_THAT(floor.verdict(0.9 * floor.force_N), ::testing::StartsWith("within the floor of"));
  }
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
  // Without the shift of their starts they differ by 0.087 N at equal times, and by 0.106 N in the data set's own
  // account: a reading that takes the shift out must come below both.
  EXPECT_LT(floor.force_N, 0.087);
  EXPECT_GT(floor.force_N, 0.05);
  EXPECT_LT(floor.position_m, 0.3e-3);
  EXPECT_THROW(repeat_floor_of_files(one, elsewhere), BadData);
}

}  // namespace
}  // namespace touchstone::sanity
