// A scan through its instruments: without their errors it is the truth, with them it is as near as they state.
#include "measured_scan.h"

#include <gmock/gmock.h>

#include <map>

#include "recipe.h"

namespace touchstone::datasets {
namespace {

constexpr std::uint64_t seed = 42;

// Through the recipe's own instruments, or through perfect ones; each is computed once.
const MeasuredScan& measured(const std::string& name, bool perfect) {
  static std::map<std::pair<std::string, bool>, MeasuredScan> kept;
  const auto found = kept.find({name, perfect});
  if (found != kept.end()) return found->second;
  const Recipe& r = recipe(name);
  const RigidScan scan = make_scan(r, seed);
  return kept[{name, perfect}] = perfect ? measure(scan, ForceSensor::perfect(), Tracker::perfect(), seed)
                                         : measure(scan, r.sensor, r.tracker, seed);
}

TEST(MeasuredScan, PerfectInstrumentsGiveTheTruthButForTheAverage) {
  const MeasuredScan& m = measured("plane", true);
  ASSERT_GT(m.recording.size(), 900U);
  double square = 0.0;
  for (std::size_t i = 0; i < m.recording.size(); ++i) {
    EXPECT_EQ(m.recording.motion.p_W_m[i], m.truth[i].p_W_m);
    square += (m.recording.f_W_N[i] - m.truth[i].f_W_N).squaredNorm();
  }
  // Averaging over the tracker's period smooths the hand's tremor and the reversals of friction, nothing else.
  EXPECT_LT(std::sqrt(square / static_cast<double>(m.recording.size())), 0.05);
}

TEST(MeasuredScan, ErrorsAreAsTheInstrumentsState) {
  for (const Recipe& r : recipes()) {
    const MeasuredScan& m = measured(r.name, false);
    const MeasuredScan& perfect = measured(r.name, true);
    double position = 0.0;
    double force = 0.0;
    for (std::size_t i = 0; i < m.recording.size(); ++i) {
      position = std::max(position, (m.recording.motion.p_W_m[i] - m.truth[i].p_W_m).norm());
      force += (m.recording.f_W_N[i] - perfect.recording.f_W_N[i]).squaredNorm();
    }
    EXPECT_LT(position, 5e-4);
    EXPECT_GT(position, 1e-4);
    force = std::sqrt(force / static_cast<double>(m.recording.size()));
    // Coloured noise and drift survive the average, steps and white noise hardly.
    EXPECT_LT(force, 0.02);
    EXPECT_GT(force, 0.003);
  }
}

TEST(MeasuredScan, NormalForcesArePositiveAndFrictionOpposesTheScan) {
  const MeasuredScan& m = measured("plane", false);
  Box3 box;
  double along = 0.0;
  double across = 0.0;
  for (std::size_t i = 1; i < m.recording.size(); ++i) {
    box.extend(m.recording.f_W_N[i]);
    const Vec3 step = m.truth[i].p_W_m - m.truth[i - 1].p_W_m;
    along += std::abs(step.y());
    across += std::abs(step.x());
    if (std::abs(m.truth[i].v_t_W_m_per_s.y()) > 0.02 && m.truth[i].normal_force_N > 1.0) {
      EXPECT_LT(m.recording.f_W_N[i].y() * m.truth[i].v_t_W_m_per_s.y(), 0.0);
    }
  }
  EXPECT_GT(along, 8.0 * across);
  EXPECT_GT(box.max().z(), 2.0);
  EXPECT_LT(box.max().z(), 4.5);
  EXPECT_GT(box.min().z(), -0.05);
}

TEST(MeasuredScan, ExactAnswerFollowsHookeAndTheOutTrajectory) {
  const Recipe& r = recipe("duck");
  const MeasuredScan& m = measured("duck", false);
  const recording::RenderedTrajectory exact = m.exact_answer(r.contact.tip_radius_m, r.stiffness_N_per_m);
  const recording::OutTrajectory out = m.out_trajectory(r.contact.tip_radius_m);
  ASSERT_EQ(exact.size(), m.recording.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_EQ(exact.t_s[i], m.recording.motion.t_s[i]);
    EXPECT_EQ(exact.contact_W_m[i], out.motion.p_W_m[i]);
    const Vec3 spring = r.stiffness_N_per_m * (exact.contact_W_m[i] - exact.tip_W_m[i]);
    const double normal = exact.f_W_N[i].dot(out.n_W[i]);
    EXPECT_LT((spring - normal * out.n_W[i]).norm(), 1e-11);
    EXPECT_EQ(exact.contact[i] == 1, normal > 0.0);
  }
}

TEST(MeasuredScan, SeedsDecide) {
  const Recipe& r = recipe("plane");
  const MeasuredScan& one = measured("plane", false);
  const auto again = measure(make_scan(r, seed), r.sensor, r.tracker, seed);
  const auto other = measure(make_scan(r, seed + 1), r.sensor, r.tracker, seed + 1);
  EXPECT_EQ(one.recording.f_W_N, again.recording.f_W_N);
  EXPECT_EQ(one.recording.motion.p_W_m, again.recording.motion.p_W_m);
  EXPECT_NE(one.recording.f_W_N, other.recording.f_W_N);
}

}  // namespace
}  // namespace touchstone::datasets
