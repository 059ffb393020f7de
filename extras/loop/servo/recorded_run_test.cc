// A run on a device beside its simulation. The device here is integrated in small steps (the classical Runge-Kutta
// method of fourth order), with a wall and a hand of its own: nothing of the loop makes the recording.
#include "servo/recorded_run.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>

#include "harness/base/error.h"
#include "servo/flat_wall.h"

namespace touchstone::servo {
namespace {

// Where the hand means to be: pressing the wall z = 0 once in 0.8 s, to and fro along x.
Vec3 meant_W_m(double t_s) { return {0.01 * std::sin(2.0 * t_s), 0.0, 0.001 + 0.005 * std::cos(7.85 * t_s)}; }

struct HeldDevice {
  double mass_kg, damping_N_s_per_m, hand_damping_N_s_per_m, hand_N_per_m, wall_N_per_m, period_s;
  int late_periods;

  // What is recorded from `start_s` of the hand's time on; the recording's clock begins at 100 s.
  [[nodiscard]] recording::Recording recorded(double start_s, double seconds) const {
    constexpr int steps = 20;
    const double h = period_s / steps;
    Vec3 x = meant_W_m(0.0), v = (meant_W_m(h) - x) / h;
    std::deque<Vec3> due(static_cast<std::size_t>(late_periods), Vec3::Zero());
    recording::Recording out;
    out.source = "small steps";
    for (int k = 0; k * period_s < start_s + seconds; ++k) {
      const double begin_s = k * period_s;
      due.push_back(Vec3(0.0, 0.0, wall_N_per_m * std::max(0.0, -x.z())));
      const Vec3 acting_N = due.front();
      due.pop_front();
      if (begin_s >= start_s) {
        out.motion.t_s.push_back(100.0 + begin_s - start_s);
        out.motion.p_W_m.push_back(x);
        out.f_W_N.push_back(acting_N);
      }
      const auto acceleration = [&](const Vec3& at, const Vec3& speed, double t) {
        const Vec3 meant_m_per_s = (meant_W_m(t + 1e-6) - meant_W_m(t - 1e-6)) / 2e-6;
        return Vec3((acting_N - damping_N_s_per_m * speed - hand_N_per_m * (at - meant_W_m(t)) -
                     hand_damping_N_s_per_m * (speed - meant_m_per_s)) /
                    mass_kg);
      };
      for (int i = 0; i < steps; ++i) {
        const double t = begin_s + i * h;
        const Vec3 a1 = acceleration(x, v, t), v2 = v + 0.5 * h * a1;
        const Vec3 a2 = acceleration(x + 0.5 * h * v, v2, t + 0.5 * h), v3 = v + 0.5 * h * a2;
        const Vec3 a3 = acceleration(x + 0.5 * h * v2, v3, t + 0.5 * h), v4 = v + h * a3;
        const Vec3 a4 = acceleration(x + h * v3, v4, t + h);
        x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
        v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
      }
    }
    return out;
  }

  [[nodiscard]] LoopSetup setup() const {
    return make_setup("virtuose-6d", "light",
                      {{"mass_kg", mass_kg},
                       {"damping_N_s_per_m", damping_N_s_per_m},
                       {"hand_mass_kg", 0.0},
                       {"hand_damping_N_s_per_m", hand_damping_N_s_per_m},
                       {"hand_stiffness_N_per_m", hand_N_per_m},
                       {"force_limit_N", 1e3},
                       {"period_s", period_s},
                       {"latency_s", late_periods * period_s}},
                      1);
  }
};

// A quiet wall; one that rings after each touch; a heavy device at another rate.
const std::array held_devices{HeldDevice{0.1, 0.0, 6.0, 300.0, 400.0, 1e-3, 1},
                              HeldDevice{0.1, 0.5, 3.0, 300.0, 1500.0, 1e-3, 1},
                              HeldDevice{0.8, 1.0, 8.0, 500.0, 900.0, 5e-4, 2}};

RecordedComparison compared(const HeldDevice& simulated, const recording::Recording& recording) {
  MotionColumns path;
  for (int k = 0; k <= 6000; ++k) {
    path.t_s.push_back(1e-3 * k);
    path.p_W_m.push_back(meant_W_m(1e-3 * k));
  }
  FlatWall wall(simulated.wall_N_per_m);
  const LoopSetup setup = simulated.setup();
  return compare_recorded(evaluate_loop(wall, path, setup, {}), setup, recording, {});
}

TEST(RecordedRun, IsWhatTheSimulationSaysAtTheTimeThatFits) {
  for (const HeldDevice& held : held_devices) {
    const RecordedComparison own = compared(held, held.recorded(1.3, 4.0));
    fmt::print("{} kg: {}\n", held.mass_kg, own.sentence);
    EXPECT_TRUE(own.agrees) << own.sentence;
    EXPECT_NEAR(own.shift_s, 1.3 - 100.0, 2e-4);
    EXPECT_LT(own.difference_m, 1e-3 * own.motion_m);
    EXPECT_LT(own.difference_N, 1e-3 * own.force_N);
    EXPECT_GT(own.compared_s, 3.9);
  }
}

TEST(RecordedRun, DiffersIfTheDeviceIsAnother) {
  const HeldDevice& right = held_devices[1];
  HeldDevice late = right, heavy = right, stiff = right;
  late.late_periods = 4;
  heavy.mass_kg *= 3.0;
  stiff.hand_N_per_m *= 2.0;
  for (const HeldDevice& wrong : {late, heavy, stiff}) {
    const RecordedComparison own = compared(wrong, right.recorded(1.3, 4.0));
    EXPECT_FALSE(own.agrees) << own.sentence;
  }
}

TEST(RecordedRun, RefusesWhatThePathDoesNotCover) {
  EXPECT_THROW(compared(held_devices[0], held_devices[0].recorded(0.0, 30.0)), BadData);
  recording::Recording forceless = held_devices[0].recorded(0.0, 3.0);
  forceless.f_W_N.clear();
  EXPECT_THROW(compared(held_devices[0], forceless), BadData);
}

}  // namespace
}  // namespace touchstone::servo
