// Verdicts on walls that theory says are stable or not.
#include "servo/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <chrono>
#include <cmath>
#include <numbers>

#include "servo/flat_wall.h"
#include "servo/limits.h"
#include "servo/linear_wall_for_test.h"

namespace touchstone::servo {
namespace {

// Down to 2 mm above a wall, into it as far as presses with 1 N, and hold.
MotionColumns press(const LoopParameters& own) {
  MotionColumns path;
  const double deep_m = 1.0 / own.axis.hand_stiffness_N_per_m;
  for (int k = 0; k <= 200; ++k) {
    const double t = 0.01 * k;
    path.t_s.push_back(t);
    path.p_W_m.emplace_back(0.0, 0.0, 2e-3 - (2e-3 + deep_m) * std::min(1.0, t / 0.3));
  }
  return path;
}

LoopParameters grip(double mass_kg, double damping, double stiffness) {
  LoopParameters own;
  own.axis = {0.1 + mass_kg, 0.5, 0.0, damping, stiffness, 0.0};
  own.hand_mass_kg = mass_kg;
  return own;
}

Judgement judged(rendering::Renderer& renderer, const LoopParameters& own) {
  return judge(run_for_judgement(renderer, press(own), own), {});
}

TEST(Verdict, ChangesWhereTheLinearLoopTurnsUnstable) {
  for (const LoopParameters& own : {grip(0.006, 4.0, 800.0), grip(0.5, 6.0, 135.0)}) {
    for (const double latency_s : {0.0, 2e-3}) {
      LoopParameters late = own;
      late.latency_s = latency_s;
      const double critical = critical_gain(late)->stiffness_N_per_m;
      FlatWall stable(0.5 * critical), unstable(1.3 * critical);
      EXPECT_EQ(judged(stable, late).verdict, Verdict::stable) << sentence(judged(stable, late));
      EXPECT_EQ(judged(unstable, late).verdict, Verdict::unstable) << sentence(judged(unstable, late));
    }
  }
}

TEST(Verdict, StepsOfTheEncoderBuzzWithTheAmplitudeAndFrequencyThatIsThere) {
  LoopParameters own = grip(0.02, 4.0, 300.0);
  own.resolution_m = 1e-4;
  FlatWall wall(0.5 * critical_gain(own)->stiffness_N_per_m);
  LoopRuns runs = run_for_judgement(wall, press(own), own);
  run_encoder(runs, wall, press(own), own);
  const LoopTrace& run = runs.run;
  const Judgement found = judge(runs, {});
  EXPECT_EQ(found.verdict, Verdict::buzzes) << sentence(found);
  EXPECT_NEAR(found.buzz.frequency_Hz, frequency_Hz(run), 2.0);
  // A sine fitted to the force on the hand there.
  Eigen::MatrixXd waves(128, 3);
  Eigen::VectorXd felt(128);
  const auto begin = static_cast<Eigen::Index>(std::lround(found.buzz.at_s / own.period_s)) - 64;
  for (Eigen::Index i = 0; i < 128; ++i) {
    const double phase = 2.0 * std::numbers::pi * found.buzz.frequency_Hz * static_cast<double>(i) * own.period_s;
    waves.row(i) << std::cos(phase), std::sin(phase), 1.0;
    felt[i] = run.felt_W_N[static_cast<std::size_t>(begin + i)].z();
  }
  const double amplitude_N = waves.colPivHouseholderQr().solve(felt).head<2>().norm();
  EXPECT_NEAR(found.buzz.amplitude_N, amplitude_N, 0.2 * amplitude_N);
}

// A vibration that the renderer makes by itself is not the loop's.
TEST(Verdict, WhatTheRendererShakesByItselfIsItsOwn) {
  class Shaking final : public rendering::Renderer {
   protected:
    void do_reset() override {}
    rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
      rendering::StepResult out;
      out.contact = tip.p_W_m.z() < 0.0;
      if (!out.contact) return out;
      const double swing_N = 0.2 * std::sin(2.0 * std::numbers::pi * 80.0 * tip.t_s);
      out.n_W = Vec3::UnitZ();
      out.f_W_N = (-300.0 * tip.p_W_m.z() + swing_N) * out.n_W;
      return out;
    }
  } renderer;
  const Judgement found = judged(renderer, grip(0.1, 6.0, 300.0));
  EXPECT_EQ(found.verdict, Verdict::stable) << sentence(found);
  EXPECT_GT(found.own.jnd, 1.0);
  EXPECT_NEAR(found.own.frequency_Hz, 80.0, 2.0);
}

// A wall that is hit comes late: the force overshoots that of an ideal servo, in newtons and in the steps of Weber's
// law from there on.
TEST(Verdict, AKickIsWhatALateWallGivesBeyondAnIdealOne) {
  LoopParameters own = grip(0.2, 20.0, 200.0);
  FlatWall wall(3000.0);
  const auto runs_of = [&] { return run_for_judgement(wall, press(own), own); };
  EXPECT_LT(judge(runs_of(), {}).kick_jnd, 0.5);
  own.latency_s = 4e-3;
  const LoopRuns runs = runs_of();
  const Judgement late = judge(runs, {});
  const auto largest_N = [](const LoopTrace& trace) {  // in the 64 ms of the first contact
    std::size_t first = 0;
    while (trace.contact[first] == 0) ++first;
    double largest = 0.0;
    for (std::size_t i = first; i < first + 64; ++i) largest = std::max(largest, trace.felt_W_N[i].norm());
    return largest;
  };
  const double ideal_N = largest_N(runs.ideal), kick_N = largest_N(runs.run) - ideal_N;
  EXPECT_GT(late.kick_jnd, 1.0);
  EXPECT_NEAR(late.kick_N, kick_N, 0.02 * kick_N);
  EXPECT_NEAR(late.kick_jnd, kick_N / (ideal_N * perception::fingertip_force.fraction(ideal_N)), 0.02 * late.kick_jnd);
}

// The hand means to be in the wall from 0.05 s on, bounces off it at 0.1 s, and comes again at 0.3 s.
TEST(Verdict, AKickIsOfTheFirstContactOfAPress) {
  LoopRuns runs;
  const auto within = [](std::size_t i, std::size_t begin, std::size_t end) { return begin <= i && i < end; };
  for (std::size_t i = 0; i < 500; ++i) {
    const bool meant = within(i, 50, 200) || within(i, 300, 500);
    const bool touches = within(i, 52, 100) || within(i, 150, 198) || within(i, 302, 500);
    for (LoopTrace* const trace : {&runs.run, &runs.ideal, &runs.open}) {
      trace->t_s.push_back(1e-3 * static_cast<double>(i));
      trace->contact.push_back((trace == &runs.open ? meant : touches) ? 1 : 0);
      trace->limited.push_back(0);
      trace->by_actuator_J.push_back(0.0);
      trace->felt_W_N.emplace_back(0.0, 0.0, touches ? 1.0 : 0.0);
    }
  }
  const auto give = [&runs](std::size_t i, double force_N) { runs.run.felt_W_N[i].z() = force_N; };
  give(60, 1.5);
  give(160, 4.0);
  EXPECT_EQ(judge(runs, {}).kick_N, 0.5);
  EXPECT_EQ(judge(runs, {}).kick_at_s, 0.06);
  give(310, 2.0);
  EXPECT_EQ(judge(runs, {}).kick_N, 1.0);
  EXPECT_EQ(judge(runs, {}).kick_at_s, 0.31);
}

// Steps that take longer than the servo's period: no verdict, and none of the long runs.
TEST(Verdict, OfARendererThatIsTooSlowForTheServoItCannotTell) {
  class Slow final : public rendering::Renderer {
   public:
    std::size_t steps = 0;

   protected:
    void do_reset() override {}
    rendering::StepResult do_step(const rendering::TipState&) noexcept override {
      ++steps;
      const auto begin = std::chrono::steady_clock::now();
      while (std::chrono::steady_clock::now() - begin < std::chrono::microseconds(300)) continue;
      return {};
    }
  } renderer;
  LoopParameters own = grip(0.1, 4.0, 300.0);
  own.period_s = 5e-4;
  const Judgement found = judged(renderer, own);
  EXPECT_EQ(found.verdict, Verdict::cannot_tell);
  EXPECT_TRUE(found.too_slow);
  EXPECT_THAT(sentence(found), ::testing::HasSubstr("of the servo's period"));
  EXPECT_LE(renderer.steps, 4001U);  // one run of 2 s
}

TEST(Verdict, WithoutContactItCannotTell) {
  FlatWall wall(500.0);
  const LoopParameters own = grip(0.1, 4.0, 300.0);
  const MotionColumns above{{0.0, 1.0}, {Vec3(0, 0, 0.01), Vec3(0.01, 0, 0.01)}, {}};
  const Judgement found = judge(run_for_judgement(wall, above, own), {});
  EXPECT_EQ(found.verdict, Verdict::cannot_tell);
}

}  // namespace
}  // namespace touchstone::servo
