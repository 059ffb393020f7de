// The simulation against what theory knows: each figure is printed and held.
#include "servo/limits.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "servo/flat_wall.h"
#include "servo/linear_wall_for_test.h"

namespace touchstone::servo {
namespace {

// A device of mass m under a servo of period T, everything else in their units: so each test is one at several scales.
struct WallScale {
  double mass_kg, period_s;
};
const std::vector<WallScale> wall_scales{{0.05, 1e-3}, {0.4, 2.5e-4}, {2.0, 1e-2}};

LoopParameters loop(const WallScale& scale, double b_T_per_m) {
  LoopParameters own;
  own.period_s = scale.period_s;
  own.axis.mass_kg = scale.mass_kg;
  own.axis.damping_N_s_per_m = b_T_per_m * scale.mass_kg / scale.period_s;
  return own;
}

// Whether a struck wall's motion grows: the logarithm of late over early.
double growth(const LoopParameters& own, double stiffness) {
  LinearWall wall(stiffness);
  const LoopTrace trace = run_loop(wall, struck(own, 1e-3, 6000.0 * own.period_s), own);
  if (trace.left_at_s) return 10.0;
  return std::log(spread_m(trace, 0.8, 1.0) / spread_m(trace, 0.4, 0.6));
}

// Where the growth is none, by the secant through two stiffnesses near the expected one.
double simulated_critical(const LoopParameters& own, double expected) {
  double a = 0.999 * expected, b = 1.001 * expected;
  const double at_a = growth(own, a), at_b = growth(own, b);
  return a - at_a * (b - a) / (at_b - at_a);
}

struct Variant {
  const char* name;
  void (*change)(LoopParameters&);
};
const std::vector<Variant> variants{
    {"bare", [](LoopParameters&) {}},
    {"latency of a third of a period", [](LoopParameters& own) { own.latency_s = own.period_s / 3.0; }},
    {"latency of 2.5 periods", [](LoopParameters& own) { own.latency_s = 2.5 * own.period_s; }},
    {"virtual damping", [](LoopParameters& own) { own.virtual_damping_N_s_per_m = 3.0 * own.axis.damping_N_s_per_m; }},
    {"virtual damping, filtered velocity",
     [](LoopParameters& own) {
       own.virtual_damping_N_s_per_m = 2.0 * own.axis.damping_N_s_per_m;
       own.velocity_cutoff_Hz = 0.05 / own.period_s;
     }},
    {"slow actuator", [](LoopParameters& own) { own.axis.actuator_time_constant_s = 1.5 * own.period_s; }},
    {"hand",
     [](LoopParameters& own) {
       own.axis.hand_damping_N_s_per_m = 2.0 * own.axis.damping_N_s_per_m;
       own.axis.hand_stiffness_N_per_m = 0.01 * own.axis.mass_kg / std::pow(own.period_s, 2);
     }},
};

TEST(Limits, TheSimulationTurnsUnstableWhereTheEigenvaluesDo) {
  double worst = 0.0;
  for (const WallScale& scale : wall_scales) {
    for (const double b : {0.02, 0.1}) {
      for (const Variant& variant : variants) {
        LoopParameters own = loop(scale, b);
        variant.change(own);
        const auto critical = critical_gain(own);
        ASSERT_TRUE(critical) << variant.name;
        const double found = simulated_critical(own, critical->stiffness_N_per_m);
        const double error = found / critical->stiffness_N_per_m - 1.0;
        worst = std::max(worst, std::abs(error));
        fmt::print("{:36} m {:5.2f} kg, T {:7.2f} us, b T/m {:4.2f}: {:10.4g} N/m at {:6.1f} Hz, error {:+.1e}\n",
                   variant.name, scale.mass_kg, 1e6 * scale.period_s, b, critical->stiffness_N_per_m,
                   critical->frequency_Hz, error);
      }
    }
  }
  fmt::print("largest error of {} boundaries: {:.1e}\n", 6 * variants.size(), worst);
  EXPECT_LT(worst, 1e-4);
}

TEST(Limits, TheLinearConditionHoldsWhileMassAndPeriodAllow) {
  double worst = 0.0;
  for (const WallScale& scale : wall_scales) {
    for (const double b : {0.001, 0.005}) {
      for (const double virtual_share : {0.0, 1.0, 4.0}) {
        for (const double latency : {0.0, 1.0, 3.0}) {
          LoopParameters own = loop(scale, b);
          own.virtual_damping_N_s_per_m = virtual_share * own.axis.damping_N_s_per_m;
          own.latency_s = latency * scale.period_s;
          const auto critical = critical_gain(own);
          ASSERT_TRUE(critical);
          const double linear = linear_stiffness_N_per_m(own.axis.damping_N_s_per_m, own.virtual_damping_N_s_per_m,
                                                         own.period_s, own.latency_s);
          worst = std::max(worst, std::abs(linear / critical->stiffness_N_per_m - 1.0));
        }
      }
    }
  }
  fmt::print("K < (b + B) / (T/2 + t_d): largest error of 54 at (b + B) T/m up to 0.025: {:.1f} %\n", 100.0 * worst);
  EXPECT_LT(worst, 0.05);
}

// A motion of the hand that goes in and out of the wall, at all speeds.
MotionColumns restless(const LoopParameters& own, std::uint64_t seed) {
  MotionColumns path;
  Random random(seed);
  for (int k = 0; k < 4000; ++k) {
    path.t_s.push_back(k * own.period_s);
    const double swing = std::sin(k * 0.02) + std::sin(k * (0.3 + 0.1 * std::sin(k * 0.001)));
    path.p_W_m.emplace_back(0.0, 0.0, 1e-3 * (swing + random.normal()));
  }
  return path;
}

// The most that the hand had got out of device and wall, as a share of what it put in; below zero to rounding if both
// are passive.
double gained_share(const LoopParameters& own, double stiffness) {
  double most = -1.0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    FlatWall wall(stiffness);
    const LoopTrace trace = run_loop(wall, restless(own, seed), own);
    // It begins with the energy of its first velocity.
    double put_in_J = trace.kinetic_J.front(), gained_J = -1.0;
    for (std::size_t i = 0; i < trace.size(); ++i) {
      put_in_J = std::max(put_in_J, trace.by_hand_J[i]);
      gained_J = std::max(gained_J, -trace.by_hand_J[i] - trace.kinetic_J.front());
    }
    most = std::max(most, gained_J / put_in_J);
  }
  return most;
}

TEST(Limits, BelowColgatesLimitNoHandMakesTheWallUnstable) {
  double worst_modulus = 0.0, worst_hand = 1e9;
  for (const WallScale& scale : wall_scales) {
    for (const double b : {0.01, 0.05, 0.2}) {
      for (const double share : {0.0, 0.3, 0.8}) {
        LoopParameters own = loop(scale, b);
        own.virtual_damping_N_s_per_m = share * own.axis.damping_N_s_per_m;
        const double passive =
            passive_stiffness_N_per_m(own.axis.damping_N_s_per_m, own.virtual_damping_N_s_per_m, own.period_s);
        for (const double mass : {0.0, 1.0, 10.0}) {
          for (const double spring : {0.0, 1e-3, 0.1, 1.0, 4.0, 9.8, 30.0}) {
            LoopParameters held = own;
            held.axis.mass_kg *= 1.0 + mass;
            held.axis.hand_stiffness_N_per_m = spring * held.axis.mass_kg / std::pow(own.period_s, 2);
            for (const double k : {0.01, 0.5, 0.999})
              worst_modulus = std::max(worst_modulus, dominant_mode(held, k * passive).modulus);
          }
        }
        if (share > 0.0) continue;
        // A spring with which the device swings at half the sampling rate is the worst of masses and springs.
        own.axis.hand_stiffness_N_per_m = own.axis.mass_kg * std::pow(std::numbers::pi / own.period_s, 2);
        const auto critical = critical_gain(own);
        ASSERT_TRUE(critical);
        worst_hand = std::min(worst_hand, critical->stiffness_N_per_m / passive);
      }
    }
  }
  fmt::print(
      "below 2 (b - |B|) / T: largest modulus over 21 hands {:.9f}; with a spring unstable from {:.3f} of it on\n",
      worst_modulus, worst_hand);
  EXPECT_LT(worst_modulus, 1.0);
  // Between samples a mass on a spring moves as a sine, which loses pi^2 / 8 of what the straight motion does.
  EXPECT_NEAR(worst_hand, std::pow(std::numbers::pi, 2) / 8.0, 0.02);
}

// A hand that leads the tip to and fro between two places, straight, once a period: Colgate's limit is exact for it.
TEST(Limits, AHandThatMovesOnceAPeriodGetsEnergyFromColgatesLimitOn) {
  for (const WallScale& scale : wall_scales) {
    LoopParameters own = loop(scale, 50.0);  // hardly any mass, and the hand's damper is strong: the tip is led
    own.axis.hand_damping_N_s_per_m = 1000.0 * own.axis.damping_N_s_per_m;
    MotionColumns path;
    for (int k = 0; k < 500; ++k) {
      path.t_s.push_back(k * own.period_s);
      path.p_W_m.emplace_back(0.0, 0.0, k % 2 == 0 ? 1e-3 : -1e-3);
    }
    const double passive = passive_stiffness_N_per_m(own.axis.damping_N_s_per_m, 0.0, own.period_s);
    const auto put_in_J = [&](double share) {
      LinearWall wall(share * passive);
      const LoopTrace trace = run_loop(wall, path, own);
      return trace.by_hand_J.back() - trace.by_hand_J[100];
    };
    const double zero = 0.9 + 0.2 * put_in_J(0.9) / (put_in_J(0.9) - put_in_J(1.1));
    fmt::print("m {:5.2f} kg: the hand gets energy from {:.4f} of 2 b / T on\n", scale.mass_kg, zero);
    EXPECT_NEAR(zero, 1.0, 0.01);
  }
}

TEST(Limits, APassiveWallOnAPassiveDeviceNeverGivesTheHandEnergy) {
  for (const WallScale& scale : wall_scales) {
    LoopParameters own = loop(scale, 0.05);
    own.axis.hand_damping_N_s_per_m = 0.02 * scale.mass_kg / scale.period_s;
    own.axis.hand_stiffness_N_per_m = 0.3 * scale.mass_kg / std::pow(scale.period_s, 2);
    const double passive = passive_stiffness_N_per_m(own.axis.damping_N_s_per_m, 0.0, own.period_s);
    const double below = gained_share(own, 0.99 * passive);
    own.latency_s = 3.0 * own.period_s;
    const double late = gained_share(own, 10.0 * passive);
    fmt::print("m {:5.2f} kg: gained share of the energy {:+.1e} below the limit, {:+.1e} above it with latency\n",
               scale.mass_kg, below, late);
    EXPECT_LT(below, 1e-12);
    EXPECT_GT(late, 0.1);
  }
}

// Whether a wall with steps and friction still moves long after it was struck, and more than at the beginning.
struct Struck {
  bool moves = false, grows = false;
};
Struck strike(const LoopParameters& own, double stiffness, double amplitude_m) {
  LinearWall wall(stiffness);
  const double w = std::sqrt(stiffness / own.axis.mass_kg);
  const LoopTrace trace = run_loop(wall, struck(own, w * amplitude_m, 8000.0 * own.period_s), own);
  if (trace.left_at_s) return {true, true};
  return {spread_m(trace, 0.9, 1.0) > 1e-3 * own.resolution_m, spread_m(trace, 0.9, 1.0) > 2.0 * amplitude_m};
}

TEST(Limits, TheFourRegionsOfSamplingAndQuantisation) {
  for (const WallScale& scale : wall_scales) {
    for (const double K_T_over_2b : {0.6, 3.0}) {
      for (const double K_step_over_2F : {0.5, 5.0}) {
        LoopParameters own = loop(scale, 0.02);
        const double stiffness = K_T_over_2b * 2.0 * own.axis.damping_N_s_per_m / own.period_s;
        own.resolution_m = 1e-4;
        own.axis.friction_N = stiffness * own.resolution_m / (2.0 * K_step_over_2F);
        // Struck by some hundred steps, and nudged by a third of one.
        const Struck hard = strike(own, stiffness, 300.0 * own.resolution_m);
        const Struck soft = strike(own, stiffness, 0.3 * own.resolution_m);
        const Region where =
            region(stiffness, own.axis.damping_N_s_per_m, own.axis.friction_N, own.period_s, own.resolution_m);
        SCOPED_TRACE(fmt::format("m {} kg, {}", scale.mass_kg, name_of(where)));
        EXPECT_EQ(where == Region::large_unstable || where == Region::unstable, hard.grows);
        EXPECT_FALSE(soft.grows && where != Region::unstable);
        EXPECT_FALSE(where == Region::passive && (hard.moves || soft.moves));
        EXPECT_FALSE(where == Region::large_unstable && soft.moves);
        EXPECT_EQ(quantised_passive_stiffness_N_per_m(own.axis.damping_N_s_per_m, own.axis.friction_N, own.period_s,
                                                      own.resolution_m) >= stiffness,
                  where == Region::passive);
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::servo
