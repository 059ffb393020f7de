// A hand-held probe on a hard surface: taps before and after, scanning between; force at 5 kHz and motion at 60 Hz on
// clocks that differ in offset and rate. The alignment must find both, and say how well.
#include "tap_alignment.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "harness/base/error.h"
#include "tap_session_for_test.h"

namespace touchstone::acquisition {
namespace {

using ::testing::HasSubstr;

TEST(TapAlignment, FindsOffsetAndSkew) { check_alignment_over_seeds(20); }

TEST(TapAlignment, DoesNotDependOnUnits) {
  for (const double unit : {1e-3, 1e3}) {
    Shape shape;
    shape.unit = unit;
    const Session scaled = make_session(42, shape), plain = make_session(42, {});
    EXPECT_NEAR(align(scaled).offset_s, align(plain).offset_s, 1e-9);
  }
}

TEST(TapAlignment, WithoutNoiseTheErrorIsFarBelowASample) {
  Shape shape;
  shape.motion_noise = 0.0;
  shape.force_noise = 1e-6;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Session s = make_session(seed, shape);
    EXPECT_LT(worst_error(s, align(s)), 0.25e-3) << seed;
  }
}

TEST(TapAlignment, AHandThatLeavesSlowlyDoesNotMisleadIt) {
  Shape shape;
  shape.slow_leaving = true;
  int covered = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Session s = make_session(seed, shape);
    const auto a = align(s);
    covered += centre_error(s, a) < a.interval95_at(a.reference_s);
    EXPECT_LT(worst_error(s, a), 3e-3) << seed;
  }
  EXPECT_GE(covered, 16);  // of 20 at 95 %: fewer happen once in 400
}

TEST(TapAlignment, MapsBackAndForth) {
  const auto a = align(make_session(3, {}));
  for (const double t : {0.0, 17.0, 60.0}) EXPECT_NEAR(a.to_motion_clock(a.to_force_clock(t)), t, 1e-12 * 100);
}

TEST(TapAlignment, TapsAtOneEndSayLittleOfTheOther) {
  Shape shape;
  shape.taps_after = 0;
  const Session s = make_session(4, shape);
  const auto a = align(s);
  EXPECT_GT(a.sigma_at(60.0), 2 * a.sigma_at(a.reference_s));
  EXPECT_LT(worst_error(s, a), 5 * a.sigma_at(60.0));
}

TEST(TapAlignment, RefusesWhatItCannotTell) {
  const auto complaint = [](const std::function<void()>& act) {
    try {
      act();
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  Shape none;
  none.taps_before = none.taps_after = 0;
  EXPECT_THAT(complaint([&] { align(make_session(5, none)); }), HasSubstr("give the offset of the clocks"));
  Shape even;
  even.even = true;
  even.taps_after = 0;
  even.taps_before = 6;
  Session s = make_session(6, even);
  // One tap of the motion went unseen: now two offsets fit five taps each.
  for (std::size_t i = 0; i < s.t_motion.size(); ++i) {
    if (s.t_motion[i] < 1.9) s.height[i] = 0.015;
  }
  for (std::size_t i = 0; i < s.t_force.size(); ++i) {
    if (s.t_force[i] - s.offset > 4.9 && s.t_force[i] - s.offset < 6.0) s.force[i] = 0.0;
  }
  EXPECT_THAT(complaint([&] { align(s); }), HasSubstr("uneven rhythm"));
  // The same end for other causes names them: a clock that was set half-way, and samples that were lost.
  Session stepped = make_session(8, {});
  for (double& t : stepped.t_force) t += t - stepped.offset > 30.0 ? 0.9 : 0.0;
  EXPECT_THAT(complaint([&] { align(stepped); }), HasSubstr("between them a clock was set"));
  Session lost = s;
  lost.t_force.clear(), lost.force.clear();
  for (std::size_t i = 0; i < s.t_force.size(); ++i) {
    if (i % 1000 < 40) continue;
    lost.t_force.push_back(s.t_force[i]);
    lost.force.push_back(s.force[i]);
  }
  EXPECT_THAT(complaint([&] { align(lost); }), HasSubstr("In the force, 2.4 s are missing in 299 gaps"));
  Session still = make_session(7, {});
  std::fill(still.height.begin(), still.height.end(), 0.01);
  EXPECT_THAT(complaint([&] { align(still); }), HasSubstr("no abrupt stops"));
}

}  // namespace
}  // namespace touchstone::acquisition
