// Axes made with known terms: each is found at several scales, what is not there is not named, and what the motion
// cannot tell apart is said to be so.
#include "harness/axis/axis_fit.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "harness/axis/axis_report.h"
#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::axis {
namespace {

struct Truth {
  double dry = 0.0, viscous = 0.0, inertia = 0.0, cable = 0.0;
  double width = 0.0, slope = 0.0;     // of a reversal; of the dry friction over the place
  double relaxing = 0.0, tau_s = 1.0;  // a Maxwell arm
  bool one_speed = false;
};

// 60 s at 200 Hz: swings of several speeds, or there and back at one speed.
AxisRun made_axis(const Truth& truth, double unit, double noise, Random& random) {
  AxisRun run;
  run.source = "axis.csv";
  double z = 1.0, slow = 0.0, last = 0.0;
  for (int i = 0; i < 12000; ++i) {
    const double t = i / 200.0;
    double q = std::sin(0.6 * t) + 0.3 * std::sin(2.3 * t);
    double v = 0.6 * std::cos(0.6 * t) + 0.69 * std::cos(2.3 * t);
    double a = -0.36 * std::sin(0.6 * t) - 1.587 * std::sin(2.3 * t);
    if (truth.one_speed) {
      const double phase = std::fmod(t, 10.0);
      q = phase < 5.0 ? 0.1 * phase : 1.0 - 0.1 * phase;
      v = phase < 5.0 ? 0.1 : -0.1;
      a = 0.0;
    }
    if (i == 0) last = slow = q;
    z = truth.width > 0.0 ? std::clamp(z + 2.0 * (q - last) / truth.width, -1.0, 1.0) : (v > 0 ? 1.0 : -1.0);
    last = q;
    // The exact step of a first-order lag towards a place that stands still within a sample.
    slow += (q - slow) * (1.0 - std::exp(-1.0 / 200.0 / truth.tau_s));
    const double f = (truth.dry + truth.slope * q) * z + truth.viscous * v + truth.inertia * a +
                     truth.cable * (std::sin(1.5 * q) + 0.5 * q * q) + truth.relaxing * (q - slow);
    run.t_s.push_back(t);
    run.place.push_back(q);
    run.rate.push_back(v);
    run.load.push_back(unit * (f + noise * random.normal()));
  }
  return run;
}

std::map<std::string, double> terms_of(const AxisFit& fit) {
  std::map<std::string, double> terms;
  for (const AxisTerm& term : fit.terms) terms[term.name] = term.value;
  return terms;
}

std::string names_of(const AxisFit& fit) {
  std::string names;
  for (const AxisTerm& term : fit.terms) names += (names.empty() ? "" : ", ") + term.name;
  return names;
}

TEST(AxisFit, EveryTermIsFoundAtEveryScale) {
  Random random(1);
  for (const double unit : {1e-6, 1.0, 1e4}) {
    const auto fit =
        fit_axis(made_axis({.dry = 0.07, .viscous = 0.05, .inertia = 0.01, .cable = 0.2}, unit, 0.005, random));
    auto terms = terms_of(fit);
    EXPECT_EQ(names_of(fit), "dry friction, viscous friction, inertia");
    EXPECT_NEAR(terms["dry friction"], 0.07 * unit, 0.003 * unit);
    EXPECT_NEAR(terms["viscous friction"], 0.05 * unit, 0.003 * unit);
    EXPECT_NEAR(terms["inertia"], 0.01 * unit, 0.002 * unit);
    EXPECT_FALSE(fit.friction_undecided);
    EXPECT_NEAR(fit.after, 0.005 * unit, 0.001 * unit);
  }
}

TEST(AxisFit, ReversalWidthRelaxationAndFrictionOverThePlaceAreFound) {
  Random random(5);
  const auto wide = fit_axis(made_axis({.dry = 0.07, .cable = 0.2, .width = 0.1}, 1.0, 0.005, random));
  EXPECT_EQ(names_of(wide), "dry friction, reversal width");
  EXPECT_NEAR(terms_of(wide)["reversal width"], 0.1, 0.01);
  const auto relaxing = fit_axis(made_axis({.cable = 0.2, .relaxing = 0.2, .tau_s = 1.0}, 1.0, 0.005, random));
  EXPECT_THAT(names_of(relaxing), ::testing::HasSubstr("relaxation, relaxation time"));
  EXPECT_NEAR(terms_of(relaxing)["relaxation"], 0.2, 0.03);
  EXPECT_NEAR(terms_of(relaxing)["relaxation time"], 1.0, 0.2);
  const auto sloping = fit_axis(made_axis({.dry = 0.1, .cable = 0.2, .slope = 0.05}, 1.0, 0.005, random));
  EXPECT_EQ(names_of(sloping), "friction over place");
  ASSERT_FALSE(sloping.friction_over_place.empty());
  EXPECT_NEAR(sloping.friction_over_place.back() - sloping.friction_over_place.front(),
              0.05 * (sloping.knots.back() - sloping.knots.front()), 0.01);
}

// Seeds 1000 to 1029 were not looked at while the limits were chosen.
TEST(AxisFit, WhatIsNotThereIsNotNamed) {
  std::map<std::string, int> named;
  constexpr int worlds = 30;
  for (int world = 0; world < worlds; ++world) {
    Random random(1000 + static_cast<std::uint64_t>(world));
    ++named["place alone: " + names_of(fit_axis(made_axis({.cable = 0.2}, 1.0, 0.01, random)))];
    ++named["dry: " + names_of(fit_axis(made_axis({.dry = 0.07, .cable = 0.2}, 1.0, 0.01, random)))];
    ++named["viscous: " + names_of(fit_axis(made_axis({.viscous = 0.07, .cable = 0.2}, 1.0, 0.01, random)))];
  }
  for (const auto& [what, count] : named) fmt::print("{:40} {} of {}\n", what, count, worlds);
  EXPECT_EQ(named["place alone: "], worlds);
  EXPECT_EQ(named["dry: dry friction"], worlds);
  EXPECT_EQ(named["viscous: viscous friction"], worlds);
}

TEST(AxisFit, AtOneSpeedDryAndViscousCannotBeToldApart) {
  Random random(3);
  for (const Truth& truth :
       {Truth{.dry = 0.07, .cable = 0.2, .one_speed = true}, Truth{.viscous = 0.7, .cable = 0.2, .one_speed = true}}) {
    const auto fit = fit_axis(made_axis(truth, 1.0, 0.005, random));
    EXPECT_TRUE(fit.friction_undecided);
    EXPECT_NEAR(fit.dry_alone, 0.07, 0.002);
    EXPECT_NEAR(fit.viscous_alone, 0.7, 0.02);
    EXPECT_THAT(axis_text(fit, {}, {}), ::testing::HasSubstr("cannot be told apart"));
  }
}

TEST(AxisFit, FittedLoadIsWhatTheFitSays) {
  Random random(6);
  const AxisRun run = made_axis({.dry = 0.07, .viscous = 0.05, .cable = 0.2, .width = 0.05}, 1.0, 0.005, random);
  const AxisFit fit = fit_axis(run);
  const auto fitted = fitted_load(fit, run);
  double square = 0.0;
  for (std::size_t i = 0; i < run.load.size(); ++i) square += std::pow(run.load[i] - fitted[i], 2);
  EXPECT_LT(std::sqrt(square / static_cast<double>(run.load.size())), 1.3 * fit.after);
}

TEST(AxisFit, AReversedLoadIsNamedWithItsFlag) {
  Random random(8);
  AxisRun run = made_axis({.dry = 0.07, .cable = 0.2}, 1.0, 0.005, random);
  for (double& load : run.load) load = -load;
  const AxisFit fit = fit_axis(run);
  EXPECT_TRUE(fit.reversed);
  EXPECT_THAT(axis_text(fit, {}, {}), ::testing::HasSubstr("give --flip-force"));
}

TEST(AxisFit, RunsThatCannotTellAreRefused) {
  Random random(4);
  AxisRun one_way = made_axis({.dry = 0.07, .one_speed = true}, 1.0, 0.01, random);
  for (std::size_t i = 0; i < one_way.place.size(); ++i) one_way.place[i] = 0.1 * one_way.t_s[i], one_way.rate[i] = 0.1;
  EXPECT_THROW(fit_axis(one_way), BadData);
  EXPECT_THROW(fit_axis({}), BadData);
}

}  // namespace
}  // namespace touchstone::axis
