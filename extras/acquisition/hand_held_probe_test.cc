// The alignment of clocks over sessions with a hand-held probe of 50 to 300 g, by rigid-body mechanics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hand_held_sessions_for_test.h"
#include "harness/base/error.h"

namespace touchstone::acquisition {
namespace {

using ::testing::HasSubstr;

TEST(HandHeldProbe, IsAlignedWhateverTheToolWeighs) {
  const SessionTally tally = align_sessions(2001, 4, {});
  EXPECT_EQ(tally.refused, 0);
  EXPECT_LT(tally.worst_s, 3e-3);
}

TEST(HandHeldProbe, NeedsNoTapsInTheMotionIfTheToolIsKnown) {
  ProbePlan plan;
  plan.tool_mass_low_kg = plan.tool_mass_high_kg = 0.25;
  HandHeldProbe probe(2101, plan);
  const ProbeSession s = probe.run();
  const ClockAlignment a = align_clocks(s.streams, {}, "session");
  EXPECT_GT(a.free_motion, 5U);
  EXPECT_LT(std::abs(a.to_force_clock(a.reference_s) - s.true_force_time(a.reference_s)), 3e-3);
}

// A bias that drifts pulls the start one way and the end the other, as a skew of the clocks would.
TEST(HandHeldProbe, ABiasThatDriftsMovesNeitherEnd) {
  HandHeldProbe probe(2102, {});
  ProbeSession s = probe.run();
  const ClockAlignment steady = align_clocks(s.streams, {}, "session");
  ASSERT_GT(steady.free_motion, 5U);
  const double first = s.streams.t_force_s.front(), length = s.streams.t_force_s.back() - first;
  for (std::size_t i = 0; i < s.streams.t_force_s.size(); ++i)
    s.streams.force_S_N[i] += Vec3(0.05, -0.05, 0.1) * ((s.streams.t_force_s[i] - first) / length - 0.5);
  const ClockAlignment a = align_clocks(s.streams, {}, "session");
  for (const double t : {0.0, s.length_s}) {
    EXPECT_NEAR(a.to_force_clock(t), steady.to_force_clock(t), 0.1e-3) << t;
    EXPECT_LT(std::abs(a.to_force_clock(t) - s.true_force_time(t)), 1e-3) << t;
  }
  // Near the ends two or three taps carry what is known.
  EXPECT_LT(a.error_at(0.0).degrees, a.degrees);
  EXPECT_LT(a.error_at(s.length_s).degrees, a.degrees);
}

TEST(HandHeldProbe, RefusalsSayWhatToDoNext) {
  const auto complaint = [](const ProbeSession& s) {
    try {
      align_clocks(s.streams, {}, "session");
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  HandHeldProbe probe(2201, {});
  const ProbeSession whole = probe.run();
  ProbeSession other = whole;
  HandHeldProbe stranger(2202, {});
  other.streams.t_motion_s = stranger.run().streams.t_motion_s;
  const std::size_t n = std::min(other.streams.t_motion_s.size(), whole.streams.tip_T_m.size());
  other.streams.t_motion_s.resize(n);
  other.streams.q_TS.resize(n);
  // The tracker saw a probe at rest.
  other.streams.tip_T_m.assign(n, Vec3(0.1, 0.2, 0.3));
  EXPECT_THAT(complaint(other), HasSubstr("check that direction, and that the tracker saw the probe"));
  ProbeSession brief = whole;
  brief.streams.t_force_s.resize(5);
  brief.streams.force_S_N.resize(5);
  EXPECT_THAT(complaint(brief), HasSubstr("record at least the taps"));
}

}  // namespace
}  // namespace touchstone::acquisition
