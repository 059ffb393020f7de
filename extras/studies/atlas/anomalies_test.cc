// Each detector on cases made by hand, on both sides of its limit.
#include "atlas/anomalies.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::atlas {
namespace {

// A faultless stroke along x over the plane z = 0, 0.1 mm a sample, pressed 1 mm deep.
std::vector<TrackedContact> stroke(int samples, double unit = 1.0) {
  std::vector<TrackedContact> run;
  for (int i = 0; i < samples; ++i) {
    TrackedContact now;
    now.exact_W_m = now.contact_W_m = unit * Vec3(1e-4 * i, 0, 0);
    now.exact_n_W = now.own_n_W = Vec3::UnitZ();
    now.f_W_N = Vec3(0, 0, 0.5);
    now.contact = true;
    now.exact_depth_m = 1e-3 * unit;
    now.tip_outside_m = -1e-3 * unit;
    run.push_back(now);
  }
  return run;
}

AnomalyLimits in_unit(double unit) {
  AnomalyLimits limits;
  for (double* length : {&limits.stick_lag_m, &limits.stick_path_m, &limits.slack_m, &limits.depth_m}) *length *= unit;
  return limits;
}

TEST(Anomalies, AFaultlessStrokeHasNone) {
  const Anomalies found = find_anomalies(stroke(500));
  EXPECT_TRUE(found.none());
  EXPECT_EQ(found.samples, 500U);
  EXPECT_EQ(found.largest_lag_m, 0.0);
  EXPECT_TRUE(find_anomalies({}).none());
}

TEST(Anomalies, SticksWhereTheContactPointStaysBehindForLongEnough) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    // Held at x = 10.05 mm until the exact point is at 12.9 mm: more than 1 mm behind from 11.1 mm on.
    auto run = stroke(400, unit);
    for (std::size_t i = 100; i < 130; ++i) run[i].contact_W_m = run[100].exact_W_m + Vec3(5e-5 * unit, 0, 0);
    const Anomalies found = find_anomalies(run, in_unit(unit));
    EXPECT_EQ(found.sticks, 19U) << unit;
    EXPECT_EQ(found.pops_through + found.loses_contact + found.pulls_inward, 0U);
    EXPECT_NEAR(found.largest_lag_m, 2.85e-3 * unit, 1e-9 * unit);
    // Not long enough: more than 1 mm behind for 0.9 mm of the path.
    run = stroke(400, unit);
    for (std::size_t i = 100; i < 120; ++i) run[i].contact_W_m = run[100].exact_W_m + Vec3(5e-5 * unit, 0, 0);
    EXPECT_EQ(find_anomalies(run, in_unit(unit)).sticks, 0U);
    // Friction may hold it that far.
    run = stroke(400, unit);
    for (std::size_t i = 100; i < 130; ++i) run[i].contact_W_m = run[100].exact_W_m + Vec3(5e-5 * unit, 0, 0);
    AnomalyLimits slack = in_unit(unit);
    slack.slack_m = 2e-3 * unit;
    EXPECT_EQ(find_anomalies(run, slack).sticks, 0U);
    // Ahead is not behind.
    run = stroke(400, unit);
    for (std::size_t i = 100; i < 200; ++i) run[i].contact_W_m.x() += 5e-3 * unit;
    EXPECT_EQ(find_anomalies(run, in_unit(unit)).sticks, 0U);
  }
}

TEST(Anomalies, ForceOfAContactPointThatFrictionHoldsBackRoundACornerIsNoPop) {
  // The exact point turns over an edge at 4 mm; the force stays that of the side before, leant back by friction.
  auto run = stroke(100);
  for (std::size_t i = 40; i < 100; ++i) run[i].exact_n_W = Vec3(1, 0, 0);
  for (auto& own : run) own.f_W_N = Vec3(-0.5, 0, 0.5);
  AnomalyLimits limits;
  limits.stick_lag_m = 1.05e-3;  // no sticking up to there: from 5 mm on nothing within reach has such a force
  EXPECT_EQ(find_anomalies(run, limits).pops_through, 50U);
  limits.slack_m = 2e-3;
  EXPECT_EQ(find_anomalies(run, limits).pops_through, 30U);
}

TEST(Anomalies, PopsThroughWhereTheForcePushesToTheFarSide) {
  auto run = stroke(100);
  for (std::size_t i = 40; i < 50; ++i) {
    run[i].f_W_N = Vec3(0.1, 0, -0.3);
    run[i].own_n_W = -Vec3::UnitZ();
  }
  EXPECT_EQ(find_anomalies(run).pops_through, 10U);
  EXPECT_EQ(find_anomalies(run).pulls_inward, 0U) << "out of the far side";
  for (std::size_t i = 40; i < 50; ++i) run[i].f_W_N = Vec3(0.5, 0, 0.0);
  EXPECT_EQ(find_anomalies(run).pops_through, 0U) << "tangential to rounding";
}

TEST(Anomalies, LosesContactWhereThePressedTipIsFree) {
  auto run = stroke(100);
  for (std::size_t i = 10; i < 13; ++i) {
    run[i].contact = false;
    run[i].f_W_N.setZero();
  }
  run[50].contact = false;
  run[50].f_W_N.setZero();
  run[50].exact_depth_m = 5e-6;  // hardly pressed: either answer is right
  EXPECT_EQ(find_anomalies(run).loses_contact, 3U);
}

TEST(Anomalies, PullsInwardWhereTheForcePointsIntoTheObjectOrHoldsATipThatIsOutside) {
  auto run = stroke(100);
  for (std::size_t i = 10; i < 15; ++i) run[i].own_n_W = Vec3(0, 0.6, -0.8);
  EXPECT_EQ(find_anomalies(run).pulls_inward, 5U);
  run = stroke(100);
  run[20].tip_outside_m = 2e-5;
  run[21].tip_outside_m = 5e-6;
  run[22].tip_outside_m = 1e-3;
  run[22].f_W_N.setZero();
  EXPECT_EQ(find_anomalies(run).pulls_inward, 1U);
}

// How far from tangential a force is does not depend on how strong it is.
TEST(Anomalies, AForceIsTakenForTangentialByItsDirectionAlone) {
  const AnomalyLimits limits;
  for (const double force_N : {1e-3, 1.0, 1e3}) {
    for (const double share : {0.5, 2.0}) {
      auto run = stroke(10);
      run[5].f_W_N = force_N * Vec3(1.0, 0.0, -share * limits.sine).normalized();
      const Anomalies found = find_anomalies(run, limits);
      EXPECT_EQ(found.pulls_inward, share > 1.0 ? 1U : 0U) << force_N << " N, " << share;
      EXPECT_EQ(found.pops_through, share > 1.0 ? 1U : 0U) << force_N << " N, " << share;
    }
  }
}

TEST(Anomalies, APathOfExactlyTheLimitIsLongEnough) {
  auto run = stroke(100);
  for (std::size_t i = 0; i < run.size(); ++i) run[i].exact_W_m.x() = run[i].contact_W_m.x() = std::ldexp(i, -13);
  for (std::size_t i = 40; i < 48; ++i) run[i].contact_W_m.x() = 0.0;
  AnomalyLimits limits;
  limits.stick_path_m = std::ldexp(8, -13);
  EXPECT_EQ(find_anomalies(run, limits).sticks, 8U);
  limits.stick_path_m = std::nextafter(limits.stick_path_m, 1.0);
  EXPECT_EQ(find_anomalies(run, limits).sticks, 0U);
}

}  // namespace
}  // namespace touchstone::atlas
