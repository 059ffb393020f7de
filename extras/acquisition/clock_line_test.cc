// The line between the clocks from clusters made by hand: what is assumed where they do not tell everything.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "clock_parts.h"

namespace touchstone::acquisition {
namespace {

constexpr double true_offset_s = 0.25, sigma_s = 0.5e-3;

// Taps at those times of the motion's clock, off a line of that skew through time 0 by so many sigmas.
std::vector<ClockAlignment::Event> taps_at(const std::vector<double>& times_s, double skew,
                                           const std::vector<double>& off) {
  std::vector<ClockAlignment::Event> taps;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const double t = times_s[i];
    ClockAlignment::Event tap;
    tap.motion_s = t;
    tap.force_s = t + true_offset_s + skew * t + off[i] * sigma_s;
    tap.sigma_s = sigma_s;
    taps.push_back(tap);
  }
  return taps;
}

ClockAlignment nearby_line(double skew) {
  ClockAlignment line;
  line.reference_s = 30.0;
  line.offset_s = true_offset_s + 2e-3;
  line.skew = skew;
  return line;
}

ClockAlignment fitted(const std::vector<ClockAlignment::Event>& taps, const ClockAlignment& near) {
  constexpr double interval_s = 1.0 / 60.0;
  return fit_clock_line(tap_clusters(taps, near, interval_s), near);
}

// Taps within two seconds say nothing of a skew below 100 ppm: then 0 +- 100 ppm is assumed, and the offset is the one
// that goes with it. A nearby line may come from an earlier pass that had a skew. The taps' errors have neither mean
// nor slope, so that the answer is exact.
TEST(ClockLine, ASkewOfAnEarlierPassIsNotKeptWhereNoneIsFitted) {
  for (const double earlier : {0.0, 80e-6, -300e-6}) {
    const auto line = fitted(taps_at({10.0, 10.6, 11.4, 12.0}, 0.0, {1.0, -1.0, -1.0, 1.0}), nearby_line(earlier));
    ASSERT_FALSE(line.skew_fitted) << earlier;
    EXPECT_EQ(line.skew, 0.0) << earlier;
    EXPECT_EQ(line.skew_sigma, 100e-6);
    for (const double t : {10.0, 11.0, 12.0})
      EXPECT_NEAR(line.to_force_clock(t), t + true_offset_s, 1e-12) << earlier << " at " << t;
  }
}

// Other parameters stand beside offset and skew: they too follow a skew that is held.
TEST(ClockLine, OtherParametersFollowTheAssumedSkew) {
  const ClockAlignment near = nearby_line(200e-6);
  std::vector<ClockCluster> clusters;
  for (const auto& tap : taps_at({10.0, 10.5, 11.0, 11.5, 12.0}, 0.0, {1.0, 1.0, -2.0, -1.0, 1.0})) {
    // A third parameter that acts on every second cluster alone, with an effect of 1 ms there.
    const double third = clusters.size() % 2 == 0 ? 1.0 : 0.0;
    const Eigen::Vector3d row(1.0, (tap.motion_s - near.reference_s) / clock_time_unit_s, third);
    const double off = tap.force_s - near.to_force_clock(tap.motion_s) + 1e-3 * third,
                 weight = 1.0 / (sigma_s * sigma_s);
    clusters.push_back({{weight * row * row.transpose(), weight * off * row}, tap, 0.25});
  }
  const auto line = fit_clock_line(clusters, near);
  ASSERT_FALSE(line.skew_fitted);
  EXPECT_EQ(line.skew, 0.0);
  EXPECT_NEAR(line.fit.estimate()[1], 1e-3, 1e-12);
  EXPECT_NEAR(line.to_force_clock(11.0), 11.0 + true_offset_s, 1e-12);
}

TEST(ClockLine, ASkewThatIsToldIsFitted) {
  const auto line = fitted(taps_at({1.0, 2.0, 3.0, 60.0, 61.0, 62.0}, 150e-6, {0, 0, 0, 0, 0, 0}), nearby_line(0.0));
  ASSERT_TRUE(line.skew_fitted);
  EXPECT_NEAR(line.skew, 150e-6, 1e-12);
  EXPECT_NEAR(line.to_force_clock(31.0), 31.0 + true_offset_s + 150e-6 * 31.0, 1e-12);
}

// What is not determined is not known exactly.
TEST(ClockLine, AnOffsetThatNothingDeterminesIsUnknownAtAllTimes) {
  const ClockAlignment near = nearby_line(0.0);
  std::vector<ClockCluster> clusters;
  for (const auto& tap : taps_at({10.0, 20.0, 30.0}, 0.0, {0, 0, 0})) {
    const Eigen::Vector3d row(1.0, (tap.motion_s - near.reference_s) / clock_time_unit_s, 0.0);  // the third: never
    clusters.push_back({{row * row.transpose(), 1e-3 * row}, tap, 0.25});
  }
  const auto line = fit_clock_line(clusters, near);
  EXPECT_FALSE(line.fit.determined());
  EXPECT_FALSE(line.skew_fitted);
  for (const double t : {0.0, 20.0, 60.0}) {
    EXPECT_TRUE(std::isinf(line.sigma_at(t))) << line.sigma_at(t);
    EXPECT_TRUE(std::isinf(line.interval95_at(t)));
  }
  EXPECT_TRUE(std::isinf(line.offset_sigma_s)) << line.offset_sigma_s;
}

}  // namespace
}  // namespace touchstone::acquisition
