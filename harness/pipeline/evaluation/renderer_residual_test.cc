#include "harness/pipeline/evaluation/renderer_residual.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "harness/base/random.h"
#include "harness/pipeline/evaluation/residual_series.h"

namespace touchstone::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Presses and strokes of a hand: three slow oscillations that share no period.
Vec3 force_N(double t) {
  const double press = 1.5 + std::sin(2.1 * t) + 0.3 * std::sin(17.0 * t);
  return {0.4 * std::sin(3.3 * t), -0.3 * press * std::cos(1.7 * t), press};
}

std::vector<std::string> faults_of(const std::function<Vec3(double)>& rendered, double noise_N = 0.01,
                                   double rate_Hz = 1000.0, double tip_every_s = 0.0) {
  Random random(5);
  RendererResidual residual;
  for (int i = 0; i < 8000; ++i) {
    const double t = i / rate_Hz;
    metrics::MetricSample sample;
    sample.t_s = t;
    sample.f_measured_W_N = force_N(t) + noise_N * Vec3(random.normal(), random.normal(), random.normal());
    sample.f_rendered_W_N = rendered(t);
    const double seen_s = tip_every_s > 0.0 ? tip_every_s * std::floor(t / tip_every_s + 1e-9) : t;
    residual.add(sample, 1e-3 * force_N(seen_s));
  }
  return residual.faults();
}

// Even steps, a long gap, steps that grow, and times that repeat.
TEST(ResidualSeries, FindsTheSampleAfterATimeWhateverTheSteps) {
  Random random(3);
  for (int kind = 0; kind < 4; ++kind) {
    std::vector<double> t_s{7.0};
    for (int i = 1; i < 300; ++i)
      t_s.push_back(t_s.back() + std::array{1e-3, i == 40 ? 9.0 : 1e-3, 1e-6 * std::pow(1.05, i), 0.5 * (i % 3)}[kind]);
    const std::vector<Vec3> none;
    const ResidualSeries series(t_s, none, none, none, none);
    for (int i = 0; i < 2000; ++i) {
      // Every second one is the time of a sample.
      const double at = i % 2 == 0 ? t_s[1 + i % 298] : t_s.front() + (t_s.back() - t_s.front()) * random.uniform();
      ASSERT_EQ(series.first_after(at), std::ranges::upper_bound(t_s, at) - t_s.begin()) << kind << ", " << at;
    }
  }
}

TEST(RendererResidual, ARightRendererIsNotAccused) {
  for (const double rate_Hz : {60.0, 1000.0, 5000.0}) {
    EXPECT_THAT(faults_of(force_N, 0.01, rate_Hz), IsEmpty());
    // Nor one that is too soft, without friction, with an offset, or with other noise.
    EXPECT_THAT(faults_of([](double t) { return Vec3(0.8 * force_N(t)); }, 0.01, rate_Hz), IsEmpty());
    EXPECT_THAT(faults_of([](double t) { return Vec3(0, 0, force_N(t).z()); }, 0.01, rate_Hz), IsEmpty());
    // Rounding in the place of the force along x, the same in most samples.
    EXPECT_THAT(faults_of([](double t) { return Vec3(4e-16, 0, force_N(t).z()); }, 0.01, rate_Hz), IsEmpty());
    EXPECT_THAT(faults_of([](double t) { return Vec3(force_N(t) + Vec3(0.1, 0, 0.2)); }, 0.01, rate_Hz), IsEmpty());
    EXPECT_THAT(faults_of(force_N, 0.0, rate_Hz), IsEmpty());
  }
}

TEST(RendererResidual, ALateOneIsLateBySoMuch) {
  EXPECT_THAT(faults_of([](double t) { return force_N(t - 0.021); }), ElementsAre(HasSubstr("21.0 ms behind")));
  EXPECT_THAT(faults_of([](double t) { return force_N(t - 0.005); }, 0.003), ElementsAre(HasSubstr("5.0 ms behind")));
}

TEST(RendererResidual, OneThatHoldsItsAnswersDoesSoForSoManySamples) {
  for (const auto& [hold_s, every] :
       {std::pair{0.016, "every 16th"}, {1.0 / 60.0, "every 16.7th"}, {0.007, "every 7th"}}) {
    const auto held = [hold_s = hold_s](double t) { return force_N(hold_s * std::floor(t / hold_s + 1e-9)); };
    EXPECT_THAT(faults_of(held, 0.003), ElementsAre(::testing::AllOf(HasSubstr(every), HasSubstr("would be 0.00"))));
    EXPECT_THAT(faults_of([&](double t) { return held(t - 0.02); }, 0.003),
                ElementsAre(HasSubstr("ms behind"), HasSubstr(every)));
    // A tracker that holds the position is not the renderer's fault; the force is late then, as the position is.
    EXPECT_THAT(faults_of(held, 0.003, 1000.0, hold_s), ::testing::Not(::testing::Contains(HasSubstr("held"))));
  }
  // Nor is a limit, or a renderer that answers a resting tip alike for a while.
  EXPECT_THAT(faults_of([](double t) { return force_N(t < 4.0 ? t : 4.0); }),
              ::testing::Not(::testing::Contains(HasSubstr("held"))));
}

TEST(RendererResidual, AContactPointThatIsMovedAtSomeStepsOnlyIsHeld) {
  const auto faults = [](const std::function<Vec3(int)>& contact) {
    RendererResidual residual;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 tip(1e-5 * i, 0.0, -1e-3);
      metrics::MetricSample sample;
      sample.t_s = 1e-3 * i;
      sample.contact_W_m = contact(i);
      sample.f_rendered_W_N = 500.0 * (sample.contact_W_m - tip);
      sample.f_measured_W_N = {0.0, 0.0, 0.5};
      residual.add(sample, tip);
    }
    return residual.faults();
  };
  EXPECT_THAT(
      faults([](int i) { return Vec3(4e-5 * std::floor(0.25 * i), 0.0, 0.0); }),
      testing::Contains(HasSubstr("contact point is held: it moves once in 4 samples in the mean and never at two")));
  // Friction lets go when it must.
  Random random(8);
  int held = 0;
  EXPECT_THAT(faults([&](int i) {
                if (random.uniform(0.0, 1.0) < 0.2) held = i;
                return Vec3(1e-5 * held, 0.0, 0.0);
              }),
              testing::Not(testing::Contains(HasSubstr("contact point is held"))));
  EXPECT_THAT(faults([](int i) { return Vec3(1e-5 * i, 0.0, 0.0); }), IsEmpty());
}

// A hand that taps and strokes fast enough for a filter to be told from a lag.
Vec3 quick_force_N(double t) { return force_N(t) + Vec3(0.1, 0.05, 0.3) * std::sin(160.0 * t); }

// What the renderer gives for sample after sample of a right force.
std::vector<std::string> faults_of_memory(const std::function<Vec3(const std::vector<Vec3>&)>& renderer,
                                          double noise_N = 0.01, double rate_Hz = 1000.0) {
  Random random(7);
  RendererResidual residual;
  std::vector<Vec3> right;
  for (int i = 0; i < 8000; ++i) {
    right.push_back(quick_force_N(i / rate_Hz));
    metrics::MetricSample sample;
    sample.t_s = i / rate_Hz;
    sample.f_measured_W_N = right.back() + noise_N * Vec3(random.normal(), random.normal(), random.normal());
    sample.f_rendered_W_N = renderer(right);
    residual.add(sample, 1e-3 * right.back());
  }
  return residual.faults();
}

TEST(RendererResidual, AFilterIsToldFromALagWhereTheMotionTells) {
  for (const double tau_s : {0.004, 0.02}) {
    Vec3 state = force_N(0.0);
    const double a = std::exp(-0.001 / tau_s);
    const auto filtered = [&](const std::vector<Vec3>& right) { return state = a * state + (1.0 - a) * right.back(); };
    EXPECT_THAT(faults_of_memory(filtered),
                ElementsAre(::testing::AllOf(HasSubstr("low-pass filtered"),
                                             HasSubstr(fmt::format("{:.1f} ms: undone", 1e3 * tau_s)))));
  }
  // A slow hand does not: both are said.
  EXPECT_THAT(faults_of([](double t) { return force_N(t - 0.005); }, 0.05),
              testing::AnyOf(IsEmpty(), ElementsAre(HasSubstr("does not tell it from"))));
  EXPECT_THAT(faults_of([](double t) { return force_N(t - 0.005); }, 0.01),
              ElementsAre(HasSubstr("does not tell it from: without a low-pass filter of 5.")));
}

TEST(RendererResidual, SamplesThatAreLateInTurnAreNamedByTheirPeriod) {
  const auto late = [](std::size_t period, std::size_t lag) {
    return [=](const std::vector<Vec3>& right) -> Vec3 {
      const std::size_t i = right.size() - 1;
      // Between two samples, so that none is that of the sample before.
      return i % period == 1 && i > lag ? Vec3(0.5 * (right[i - lag] + right[i - lag + 1])) : right.back();
    };
  };
  EXPECT_THAT(faults_of_memory(late(2, 1)),
              ElementsAre(HasSubstr("Of every 2 samples of the rendered force 1 are late, by 0.5")));
  EXPECT_THAT(faults_of_memory(late(3, 2)),
              ElementsAre(HasSubstr("Of every 3 samples of the rendered force 1 are late, by 1.5")));
  EXPECT_THAT(faults_of_memory(late(5, 3)),
              ElementsAre(HasSubstr("Of every 5 samples of the rendered force 1 are late, by 2.")));
}

TEST(RendererResidual, AnswersWithJitterAreNamed) {
  Random random(3);
  Vec3 last = Vec3::Zero();
  EXPECT_THAT(faults_of_memory([&](const std::vector<Vec3>& right) {
                return random.uniform(0.0, 1.0) < 0.3 ? last : last = right.back();
              }),
              testing::Contains(HasSubstr("jitter")));
  // Not a force that stays the same while the tip slides, or one of a path in steps.
  EXPECT_THAT(faults_of([](double t) { return std::fmod(t, 0.4) < 0.3 ? Vec3(0.0, 0.0, 1.0) : force_N(t); }),
              testing::Not(testing::Contains(HasSubstr("jitter"))));
}

TEST(RendererResidual, AHysteresisOfTheRendererIsNamedAndOneOfTheObjectIsNot) {
  for (const double share : {0.05, 0.3}) {
    Vec3 before = Vec3::Zero();
    const auto engine = [&](const std::vector<Vec3>& right) -> Vec3 {
      const bool falls = right.back().norm() < before.norm();
      before = right.back();
      return (falls ? 1.0 - share : 1.0) * right.back();
    };
    EXPECT_THAT(faults_of_memory(engine),
                ElementsAre(HasSubstr(fmt::format("{:.2g} % larger while it grows", 100.0 * share / (1.0 - share)))));
    const auto object = [&](const std::vector<Vec3>& right) -> Vec3 {
      const bool falls = right.back().norm() < before.norm();
      before = right.back();
      return (falls ? 1.0 : 1.0 - share) * right.back();
    };
    EXPECT_THAT(faults_of_memory(object), IsEmpty());
  }
}

TEST(RendererResidual, StepsAreNamedWhereTheyMatter) {
  const auto steps = [](double step_N) {
    return [step_N](double t) { return Vec3(step_N * (force_N(t) / step_N).array().round().matrix()); };
  };
  EXPECT_THAT(faults_of(steps(0.05)), ElementsAre(HasSubstr("a multiple of 0.05 N")));
  EXPECT_THAT(faults_of(steps(0.001)), IsEmpty());
  // One component in steps is no steps of the force.
  EXPECT_THAT(faults_of([&](double t) { return Vec3(steps(0.05)(t).x(), force_N(t).y(), force_N(t).z()); }), IsEmpty());
}

TEST(RendererResidual, MirroredAndExchangedAxesAreNamed) {
  EXPECT_THAT(faults_of([](double t) { return Vec3(force_N(t).x(), -force_N(t).y(), force_N(t).z()); }),
              ElementsAre(HasSubstr("(x, -y, z)")));
  EXPECT_THAT(faults_of([](double t) { return Vec3(force_N(t).y(), force_N(t).x(), force_N(t).z()); }),
              ElementsAre(HasSubstr("(y, x, z)")));
}

TEST(RendererResidual, ALimitIsNamedWithItsAxis) {
  EXPECT_THAT(faults_of([](double t) {
                const Vec3 f = force_N(t);
                return Vec3(f.norm() > 2.0 ? Vec3(2.0 / f.norm() * f) : f);
              }),
              ElementsAre(::testing::AllOf(HasSubstr("never exceeds 2 N,"), HasSubstr("cut there"))));
  EXPECT_THAT(faults_of([](double t) { return Vec3(force_N(t).cwiseMin(1.8).cwiseMax(-1.8)); }),
              ElementsAre(HasSubstr("1.8 N along z")));
}

TEST(RendererResidual, MissingSamplesAreCounted) {
  EXPECT_THAT(
      faults_of([](double t) { return std::lround(1000.0 * t) % 900 == 450 ? Vec3(Vec3::Zero()) : force_N(t); }),
      ElementsAre(HasSubstr("In 9 samples, at 9 times and first at 0.4500 s")));
  EXPECT_THAT(faults_of([](double t) { return std::lround(1000.0 * t) % 2000 < 3 ? Vec3(Vec3::Zero()) : force_N(t); }),
              ElementsAre(HasSubstr("In 9 samples, at 3 times and first at 2.0000 s")));
  // A renderer that leaves early has another fault.
  EXPECT_THAT(faults_of([](double t) { return std::lround(1000.0 * t) % 900 < 40 ? Vec3(Vec3::Zero()) : force_N(t); }),
              IsEmpty());
}

TEST(RendererResidual, NumbersThatAreNoneAreLeftOut) {
  EXPECT_THAT(faults_of([](double t) {
                return t > 4.0 && t < 4.01 ? Vec3(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()))
                                           : force_N(t);
              }),
              IsEmpty());
}

}  // namespace
}  // namespace touchstone::pipeline
