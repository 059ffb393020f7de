// The exact integration against closed forms, over four decades of mass and period, and the balance of energy.
#include "servo/axis_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/random.h"

namespace touchstone::servo {
namespace {

struct Scale {
  double mass_kg, period_s;
};
class AtScale : public ::testing::TestWithParam<Scale> {};
INSTANTIATE_TEST_SUITE_P(Scales, AtScale,
                         ::testing::Values(Scale{0.006, 1e-4}, Scale{0.05, 1e-3}, Scale{0.6, 1e-3}, Scale{20.0, 1e-2}));

TEST_P(AtScale, ADampedSpringFollowsItsClosedForm) {
  const auto [m, T] = GetParam();
  AxisParameters own;
  own.mass_kg = m;
  own.hand_stiffness_N_per_m = m * std::pow(0.3 / T, 2);  // w T = 0.3
  own.damping_N_s_per_m = 0.04 * m / T;
  own.hand_damping_N_s_per_m = 0.02 * m / T;
  const AxisTransitions transitions(own, T);
  AxisMotion axis(transitions);
  axis.start_at(1e-3, 0.0);
  const double decay = 0.03 / T, w = std::sqrt(std::pow(0.3 / T, 2) - decay * decay);
  double worst = 0.0;
  for (int k = 1; k <= 400; ++k) {
    axis.advance(period_quanta);
    const double t = k * T;
    const double y = 1e-3 * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
    worst = std::max(worst, std::abs(axis.deviation_m() - y));
  }
  EXPECT_LT(worst, 1e-14) << "of 1e-3 m";
  RecordProperty("worst_error_m", std::to_string(worst));
}

TEST_P(AtScale, AnyTimeIsTheSumOfItsParts) {
  const auto [m, T] = GetParam();
  AxisParameters own{m, 0.1 * m / T, 0.0, 0.2 * m / T, m * std::pow(0.5 / T, 2), 0.3 * T};
  const AxisTransitions plain(own, T), known(own, T, {period_quanta / 3, period_quanta - period_quanta / 3});
  AxisMotion whole(plain), parts(plain), frequent(known);
  for (AxisMotion* axis : {&whole, &parts, &frequent}) {
    axis->start_at(1e-3, 0.01);
    axis->command(0.7);
    axis->intend(0.05);
  }
  whole.advance(period_quanta);
  for (AxisMotion* axis : {&parts, &frequent}) {
    axis->advance(period_quanta / 3);
    axis->advance(period_quanta - period_quanta / 3);
    EXPECT_NEAR(axis->deviation_m(), whole.deviation_m(), 1e-13 * std::abs(whole.deviation_m()));
    EXPECT_NEAR(axis->velocity_m_per_s(), whole.velocity_m_per_s(), 1e-13 * std::abs(whole.velocity_m_per_s()));
    EXPECT_NEAR(axis->work().by_hand_J, whole.work().by_hand_J, 1e-12 * std::abs(whole.work().by_hand_J));
  }
}

TEST_P(AtScale, DryFrictionStopsAMassWhereItsEnergyIsSpent) {
  const auto [m, T] = GetParam();
  AxisParameters own;
  own.mass_kg = m;
  own.friction_N = 0.03 * m / T;  // stops 0.1 m/s after 3.33 periods
  const AxisTransitions transitions(own, T);
  AxisMotion axis(transitions);
  axis.start_at(0.0, 0.1);
  for (int k = 0; k < 10; ++k) axis.advance(period_quanta);
  const double way = m * 0.1 * 0.1 / (2.0 * own.friction_N);
  EXPECT_TRUE(axis.resting());
  EXPECT_EQ(axis.velocity_m_per_s(), 0.0);
  EXPECT_NEAR(axis.deviation_m(), way, 1e-13 * way);
  EXPECT_NEAR(axis.work().dry_J, 0.5 * m * 0.01, 1e-13 * m);
}

// A spring pulled with the speed q holds a body at rest until k q t is the friction; then it goes on without inertia's
// delay as y'' = -(k/m) y - F/m, whose closed form is known.
TEST_P(AtScale, ABodyAtRestBreaksLooseWhereThePullExceedsTheFriction) {
  const auto [m, T] = GetParam();
  const double q = 0.02, w = 0.4 / T;
  AxisParameters own;
  own.mass_kg = m;
  own.hand_stiffness_N_per_m = m * w * w;
  own.friction_N = own.hand_stiffness_N_per_m * q * 5.3 * T;  // breaks loose after 5.3 periods
  const AxisTransitions transitions(own, T);
  AxisMotion axis(transitions);
  axis.intend(q);
  for (int k = 0; k < 5; ++k) axis.advance(period_quanta);
  EXPECT_TRUE(axis.resting());
  EXPECT_NEAR(axis.deviation_m(), -q * 5.0 * T, 1e-14 * q * T);
  for (int k = 0; k < 2; ++k) axis.advance(period_quanta);
  const double t = 1.7 * T;  // since then: way x = q (t - sin(w t) / w)
  EXPECT_FALSE(axis.resting());
  EXPECT_NEAR(axis.deviation_m(), q * (t - std::sin(w * t) / w) - q * 7.0 * T, 1e-12 * q * T);
}

TEST_P(AtScale, WorkBalancesKineticEnergyToRounding) {
  const auto [m, T] = GetParam();
  const double f = m / T * 0.05;  // changes the velocity by 0.05 m/s in a period
  AxisParameters own{m, 0.05 * m / T, 0.3 * f, 0.1 * m / T, m * std::pow(0.2 / T, 2), 0.4 * T};
  const AxisTransitions transitions(own, T);
  AxisMotion axis(transitions);
  Random random(7);
  double worst = 0.0, through = 0.0, before = 0.0;
  int rests = 0;
  for (int k = 0; k < 3000; ++k) {
    axis.command(random.uniform(-f, f));
    axis.intend(random.uniform(-0.05, 0.05));
    axis.advance(period_quanta / 7);
    axis.command(random.uniform(-f, f));
    axis.advance(period_quanta - period_quanta / 7);
    rests += axis.resting() ? 1 : 0;
    const PortWork& work = axis.work();
    through += std::abs(work.by_actuator_J + work.by_hand_J - before);
    before = work.by_actuator_J + work.by_hand_J;
    const double kinetic_J = 0.5 * m * std::pow(axis.velocity_m_per_s(), 2);
    worst = std::max(worst, std::abs(kinetic_J - (before - work.viscous_J - work.dry_J)));
  }
  EXPECT_GT(rests, 10) << "the test must see rest, reversals and sliding";
  EXPECT_LT(worst, 1e-12 * through);
  RecordProperty("worst_share", std::to_string(worst / through));
}

}  // namespace
}  // namespace touchstone::servo
