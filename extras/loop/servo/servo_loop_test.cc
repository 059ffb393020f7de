// The loop as a whole: that it is what its parameters say, repeats to the bit, and balances.
#include "servo/servo_loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"
#include "servo/flat_wall.h"
#include "servo/linear_wall_for_test.h"

namespace touchstone::servo {
namespace {

LoopParameters all_effects() {
  LoopParameters own;
  own.axis = {0.2, 0.5, 0.05, 4.0, 300.0, 2e-4};
  own.hand_mass_kg = 0.1;
  own.latency_s = 1.7e-3;
  own.jitter_s = 4e-4;
  own.resolution_m = 2e-5;
  own.force_limit_N = 3.0;
  own.virtual_damping_N_s_per_m = 2.0;
  own.velocity_cutoff_Hz = 150.0;
  own.seed = 11;
  return own;
}

// Presses and releases, and a way to the side.
MotionColumns presses() {
  MotionColumns path;
  for (int k = 0; k <= 300; ++k) {
    const double t = 0.01 * k;
    path.t_s.push_back(t);
    path.p_W_m.emplace_back(0.01 * std::sin(t), 0.0, 0.004 * std::cos(4.0 * t) - 0.002);
  }
  return path;
}

TEST(ServoLoop, RepeatsToTheBitAndItsJitterGoesWithTheSeed) {
  LoopParameters own = all_effects();
  FlatWall wall(1500.0);
  const LoopTrace once = run_loop(wall, presses(), own), again = run_loop(wall, presses(), own);
  own.seed = 12;
  const LoopTrace other = run_loop(wall, presses(), own);
  ASSERT_EQ(once.size(), 3000u);
  bool differs = false;
  for (std::size_t i = 0; i < once.size(); ++i) {
    ASSERT_EQ(once.tip_W_m[i], again.tip_W_m[i]);
    ASSERT_EQ(once.felt_W_N[i], again.felt_W_N[i]);
    differs = differs || once.tip_W_m[i] != other.tip_W_m[i];
    const double late_s = once.t_s[i] - static_cast<double>(i) * own.period_s;
    ASSERT_TRUE(late_s > -1e-12 && late_s < own.jitter_s + 1e-12) << late_s;
  }
  EXPECT_TRUE(differs);
}

TEST(ServoLoop, EnergyBalancesToRoundingWithEveryEffect) {
  FlatWall wall(1500.0);
  const LoopTrace trace = run_loop(wall, presses(), all_effects());
  double worst_J = 0.0, largest_J = 0.0;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const auto since = [i](const std::vector<double>& energy_J) { return energy_J[i] - energy_J[0]; };
    largest_J = std::max(largest_J, since(trace.lost_J));
    worst_J = std::max(worst_J, std::abs(since(trace.kinetic_J) - since(trace.by_actuator_J) - since(trace.by_hand_J) +
                                         since(trace.lost_J)));
  }
  EXPECT_GT(largest_J, 1e-3);
  EXPECT_LT(worst_J, 1e-12 * largest_J);
}

TEST(ServoLoop, PositionsAreRoundedAndTheForceIsLimited) {
  LoopParameters own = all_effects();
  own.virtual_damping_N_s_per_m = 0.0;
  own.force_limit_N = 1.0;
  FlatWall wall(1500.0);
  const LoopTrace trace = run_loop(wall, presses(), own);
  bool limited = false;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const double steps = trace.commanded_W_N[i].z() / (1500.0 * own.resolution_m);
    if (trace.limited[i] == 0) {
      ASSERT_NEAR(steps, std::round(steps), 1e-9);
    } else {
      ASSERT_NEAR(trace.commanded_W_N[i].norm(), 1.0, 1e-12);
    }
    limited = limited || trace.limited[i] != 0;
  }
  EXPECT_TRUE(limited);
}

// A held force acts for a whole period, and not before its latency is over: with a force that jumps at a known tick,
// a free mass moves as the closed form of a constant force from then on.
TEST(ServoLoop, TheForceActsAfterTheLatencyToTheInstant) {
  class Step final : public rendering::Renderer {
   protected:
    void do_reset() override {}
    rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
      rendering::StepResult out;
      if (tip.t_s > 9.5e-3) out.f_W_N = Vec3(0.0, 0.0, 2.0);
      return out;
    }
  } step;
  for (const double latency_s : {0.0, 0.3e-3, 1e-3, 4.61e-3}) {
    LoopParameters own;
    own.axis.mass_kg = 0.05;
    own.latency_s = latency_s;
    const MotionColumns still{{0.0, 0.1}, {Vec3::Zero(), Vec3::Zero()}, {}};
    const LoopTrace trace = run_loop(step, still, own);
    for (const std::size_t i : {15u, 40u, 90u}) {
      const double since_s = trace.t_s[i] - 10e-3 - latency_s;
      EXPECT_NEAR(trace.tip_W_m[i].z(), 0.5 * 2.0 / 0.05 * since_s * since_s, 1e-13);
    }
  }
}

TEST(ServoLoop, ShiftingTheWorldChangesNothing) {
  LoopParameters own = all_effects();
  own.resolution_m = std::ldexp(1.0, -16);  // and places that it divides
  FlatWall wall(1500.0);
  MotionColumns path = presses();
  const LoopTrace here = run_loop(wall, path, own);
  const double away = 40960.0 * own.resolution_m;
  for (Vec3& p : path.p_W_m) p += Vec3(away, -away, 0.0);
  const LoopTrace there = run_loop(wall, path, own);
  for (std::size_t i = 0; i < here.size(); ++i)
    ASSERT_NEAR((there.felt_W_N[i] - here.felt_W_N[i]).norm(), 0.0, 1e-8) << i;
}

TEST(ServoLoop, AWallThatPushesWithoutBoundEndsTheRun) {
  LoopParameters own;
  own.axis.mass_kg = 0.01;
  LinearWall wall(1e5);
  const LoopTrace trace = run_loop(wall, struck(own, 0.1, 10.0), own);
  ASSERT_TRUE(trace.left_at_s);
  EXPECT_LT(*trace.left_at_s, 0.1);
  EXPECT_LT(trace.size(), 100u);
}

TEST(ServoLoop, RefusesWhatMakesNoSense) {
  FlatWall wall(100.0);
  const MotionColumns path{{0.0, 0.1}, {Vec3::Zero(), Vec3::Zero()}, {}};
  const auto refused = [&](void (*change)(LoopParameters&)) {
    LoopParameters own = all_effects();
    change(own);
    EXPECT_THROW(run_loop(wall, path, own), UsageError);
  };
  refused([](LoopParameters& own) { own.axis.mass_kg = 0.0; });
  refused([](LoopParameters& own) { own.axis.mass_kg = std::nan(""); });
  refused([](LoopParameters& own) { own.hand_mass_kg = 1.0; });
  refused([](LoopParameters& own) { own.period_s = 0.0; });
  refused([](LoopParameters& own) { own.jitter_s = own.period_s; });
  refused([](LoopParameters& own) { own.latency_s = -1e-3; });
  refused([](LoopParameters& own) { own.resolution_m = std::nan(""); });
  refused([](LoopParameters& own) { own.axis.friction_N = std::nan(""); });
  refused([](LoopParameters& own) { own.axis.mass_kg = std::numeric_limits<double>::infinity(); });
  refused([](LoopParameters& own) { own.period_s = 1e-12, own.jitter_s = own.latency_s = 0.0; });
  EXPECT_THROW(run_loop(wall, MotionColumns{}, all_effects()), UsageError);
}

}  // namespace
}  // namespace touchstone::servo
