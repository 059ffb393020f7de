// Vibrations that settle, and the size from which on a wall is unstable, against describing functions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>

#include "servo/limits.h"
#include "servo/linear_wall_for_test.h"

namespace touchstone::servo {
namespace {

struct CycleScale {
  double mass_kg, period_s, step_m;
};
const std::vector<CycleScale> cycle_scales{{0.05, 1e-3, 5e-5}, {0.4, 2.5e-4, 1e-6}, {2.0, 1e-2, 1e-3}};

LoopParameters with_steps(const CycleScale& scale, double b_T_per_m, double latency_periods) {
  LoopParameters own;
  own.period_s = scale.period_s;
  own.axis.mass_kg = scale.mass_kg;
  own.axis.damping_N_s_per_m = b_T_per_m * scale.mass_kg / scale.period_s;
  own.latency_s = latency_periods * scale.period_s;
  own.resolution_m = scale.step_m;
  return own;
}

LoopTrace long_after(const LoopParameters& own, double stiffness, double amplitude_m, double at_m) {
  LinearWall wall(stiffness, at_m);
  const double w = std::sqrt(stiffness / own.axis.mass_kg);
  return run_loop(wall, struck(own, w * amplitude_m, 40000.0 * own.period_s), own);
}

struct Errors {
  double amplitude = 0.0, frequency = 0.0;
  void add(const LoopTrace& trace, double amplitude_m, double expected_Hz, const std::string& what) {
    const double found_m = std::sqrt(2.0) * spread_m(trace, 0.8, 1.0);
    const double a = found_m / amplitude_m - 1.0, f = frequency_Hz(trace) / expected_Hz - 1.0;
    fmt::print("{}: {:.4g} m at {:.4g} Hz, errors {:+.1f} % and {:+.1f} %\n", what, amplitude_m, expected_Hz, 100.0 * a,
               100.0 * f);
    amplitude = std::max(amplitude, std::abs(a));
    frequency = std::max(frequency, std::abs(f));
  }
};

// The latency is several periods: with less, a vibration locks to the sampling, and the force comes up to half a period
// sooner or later than the mean that describing functions know of.
TEST(LimitCycle, AWallInTheMiddleOfAStepSettlesAtThePredictedVibration) {
  Errors worst;
  for (const CycleScale& scale : cycle_scales) {
    for (const double latency : {6.3, 12.6}) {
      for (const double share : {0.85, 0.95}) {
        const LoopParameters own = with_steps(scale, 0.01, latency);
        const double stiffness = share * critical_gain(own)->stiffness_N_per_m;
        const auto cycle = limit_cycle(own, stiffness);
        ASSERT_TRUE(cycle);
        worst.add(long_after(own, stiffness, 1.2 * cycle->amplitude_m, 0.0), cycle->amplitude_m, cycle->frequency_Hz,
                  fmt::format("step {:g} m, latency {} periods, K {:.2f} of critical", scale.step_m, latency, share));
      }
    }
  }
  EXPECT_LT(worst.amplitude, 0.08);
  EXPECT_LT(worst.frequency, 0.03);
}

// At the edge of a step the quantiser is a relay of +- K Delta / 2, as long as the vibration is within a step. The
// describing function errs by 7 % of the frequency there, since the harmonics come back; Tsypkin's condition counts
// them (Relay Control Systems, 1984): the sum over odd n of Im G(i n w) / n is 0, G with the latency and half a period.
double relay_frequency_rad_per_s(const LoopParameters& own) {
  const double late_s = own.latency_s + 0.5 * own.period_s;
  const auto sum = [&](double w) {
    double total = 0.0;
    for (int n = 1; n < 400; n += 2) {
      const std::complex<double> s(0.0, n * w);
      const auto g = std::exp(-s * late_s) / (s * (own.axis.mass_kg * s + own.axis.damping_N_s_per_m));
      total += g.imag() / n;
    }
    return total;
  };
  double low = 0.01 / late_s, high = 1.0 / late_s;  // below: friction rules, above: the latency
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (sum(middle) * sum(low) > 0.0 ? low : high) = middle;
  }
  return low;
}

TEST(LimitCycle, AWallAtTheEdgeOfAStepAlwaysVibrates) {
  Errors worst;
  for (const CycleScale& scale : cycle_scales) {
    for (const double share : {0.2, 0.4, 0.7}) {
      const LoopParameters own = with_steps(scale, 0.01, 9.5);
      const double stiffness = share * critical_gain(own)->stiffness_N_per_m;
      const double w = relay_frequency_rad_per_s(own);
      const double amplitude_m = 2.0 * stiffness * own.resolution_m / std::numbers::pi /
                                 (w * std::hypot(own.axis.mass_kg * w, own.axis.damping_N_s_per_m));
      worst.add(long_after(own, stiffness, 0.4 * own.resolution_m, 0.5 * own.resolution_m), amplitude_m,
                w / (2.0 * std::numbers::pi), fmt::format("step {:g} m, K {:.1f} of critical", scale.step_m, share));
    }
  }
  EXPECT_LT(worst.amplitude, 0.05);
  EXPECT_LT(worst.frequency, 0.03);
}

// Coulomb friction F holds small motions: unstable from the amplitude on at which b + 4 F / (pi A w) no longer is
// what the stiffness needs.
TEST(LimitCycle, FrictionHoldsAnUnstableWallUpToThePredictedAmplitude) {
  double worst = 0.0;
  for (const CycleScale& scale : cycle_scales) {
    for (const double share : {1.5, 3.0}) {
      LoopParameters own = with_steps(scale, 0.01, 0.0);
      own.resolution_m = 0.0;
      const double stiffness = share * critical_gain(own)->stiffness_N_per_m;
      LoopParameters damped = own;  // what would just be enough
      damped.axis.damping_N_s_per_m *= share;
      for (int i = 0; i < 20; ++i)
        damped.axis.damping_N_s_per_m *= stiffness / critical_gain(damped)->stiffness_N_per_m;
      const double w = 2.0 * std::numbers::pi * critical_gain(damped)->frequency_Hz;
      const double amplitude_m = 20.0 * scale.step_m;
      own.axis.friction_N =
          (damped.axis.damping_N_s_per_m - own.axis.damping_N_s_per_m) * std::numbers::pi * amplitude_m * w / 4.0;
      double held = 0.5, free = 2.0;  // of that amplitude
      for (int i = 0; i < 12; ++i) {
        const double middle = 0.5 * (held + free);
        LinearWall wall(stiffness);
        const LoopTrace trace = run_loop(wall, struck(own, w * middle * amplitude_m, 4000.0 * own.period_s), own);
        const bool grew = trace.left_at_s || spread_m(trace, 0.8, 1.0) > spread_m(trace, 0.0, 0.1);
        (grew ? free : held) = middle;
      }
      fmt::print("m {} kg, K {} of critical: unstable from {:.3f} of the predicted amplitude on\n", scale.mass_kg,
                 share, held);
      worst = std::max(worst, std::abs(held - 1.0));
    }
  }
  EXPECT_LT(worst, 0.10);
}

}  // namespace
}  // namespace touchstone::servo
