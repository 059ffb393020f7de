// Objects that differ from place to place: strokes over a spring whose stiffness has a lump or a step, by two hands.
#include "harness/perception/judge/place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "harness/base/random.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

using ::testing::HasSubstr;

constexpr double half_m = 0.03;  // of a stroke

double even(double) { return 320.0; }
double lump(double x_m) { return 320.0 * (1.0 + 1.4 * std::exp(-std::pow((x_m - 0.008) / 0.006, 2) / 2.0)); }
double slippery(double) { return 0.0; }
double rubbing(double) { return 0.3; }
// Twice the friction on the left half.
double rubs_left(double x_m) { return 0.3 * (1.0 + 1.0 / (1.0 + std::exp(x_m / 0.0005))); }
double halves(double x_m) { return 320.0 * (1.0 + 0.6 / (1.0 + std::exp(-x_m / 0.0005))); }

struct Strokes {
  std::function<double(double)> stiffness_N_per_m = even;
  int count = 6;
  double noise_N = 0.004;
  double tracker_m = 2e-6;
  double depth_m = 0.002;
  double pace = 1.0;
  double towards_rad = 0.0;
  double rate_Hz = 500.0;
  double from_m = -half_m;
  double to_m = half_m;
  std::function<double(double)> friction = slippery;
};

Recording strokes(const Strokes& own, std::uint64_t seed) {
  Random random(seed);
  Recording recording;
  recording.source = "strokes";
  const Vec3 along(std::cos(own.towards_rad), std::sin(own.towards_rad), 0.0);
  double t = 0.0;
  double before_m = own.from_m;
  const auto ramp = [](double share) { return 0.5 - 0.5 * std::cos(std::numbers::pi * std::clamp(share, 0.0, 1.0)); };
  for (int stroke = 0; stroke < own.count; ++stroke) {
    const double depth_m = own.depth_m * random.uniform(0.9, 1.1);
    const double slide_s = 2.2 / own.pace * random.uniform(0.9, 1.1);
    // In the air, down, along and up.
    for (double s = 0.0; s < slide_s + 1.4; s += 1.0 / own.rate_Hz, t += 1.0 / own.rate_Hz) {
      const double down = ramp((s - 0.4) / 0.4) - ramp((s - slide_s - 0.9) / 0.4);
      const double share = ramp((s - 0.85) / slide_s);
      const double x_m = own.from_m + (own.to_m - own.from_m) * (stroke % 2 == 0 ? share : 1.0 - share);
      const double d_m = -0.002 + (depth_m + 0.002) * down;
      const auto noise = [&](double sigma) {
        const double a = random.normal();
        const double b = random.normal();
        return Vec3(sigma * Vec3(a, b, random.normal()));
      };
      const double force_N = d_m > 0.0 ? own.stiffness_N_per_m(x_m) * d_m : 0.0;
      const double speed_m_per_s = (x_m - before_m) * own.rate_Hz;
      before_m = x_m;
      const double drag_N = force_N * own.friction(x_m) * std::tanh(speed_m_per_s / 0.002);
      recording.motion.t_s.push_back(t);
      recording.motion.p_W_m.push_back(x_m * along - d_m * Vec3::UnitZ() + noise(own.tracker_m));
      recording.f_W_N.push_back(force_N * Vec3::UnitZ() - drag_N * along + noise(own.noise_N));
    }
  }
  return recording;
}

Judgement judged(const Strokes& real, const Strokes& other, std::uint64_t seed) {
  const RecordingSource again{"again", [&] { return strokes(real, seed + 1); }};
  const auto result = judge_conditions(strokes(real, seed), {again},
                                       {{"other", [&] { return strokes(other, seed + 2); }}}, Vec3::UnitZ(), {});
  return result.conditions.front().judgement;
}

const ChannelEvidence& force_of(const Judgement& judgement) {
  return judgement.channels[static_cast<std::size_t>(Channel::force)];
}

TEST(Place, ALumpIsNamedByItsPlaceWhereverTheStrokesLie) {
  for (const double towards_rad : {0.0, 0.7, std::numbers::pi / 2.0}) {
    Strokes real{.stiffness_N_per_m = lump, .towards_rad = towards_rad};
    Strokes other = real;
    other.stiffness_N_per_m = even;
    other.pace = 1.2;
    const auto judgement = judged(real, other, 7400);
    EXPECT_EQ(judgement.verdict, Verdict::noticed);
    ASSERT_TRUE(judgement.gives_away.has_value());
    EXPECT_EQ(*judgement.gives_away, Channel::force);
    EXPECT_THAT(force_of(judgement).what, HasSubstr("softer in"));
    const auto* strongest = judgement.places.force.strongest();
    ASSERT_NE(strongest, nullptr);
    const Vec3 top(0.008 * std::cos(towards_rad), 0.008 * std::sin(towards_rad), 0.0);
    EXPECT_LT((strongest->centre_m - top).norm(), judgement.places.force.cell_m) << strongest->centre_m.transpose();
    // 2.3 times the stiffness there, in a cell as wide as the lump.
    EXPECT_NEAR(strongest->real_N / strongest->rendered_N, 2.3, 0.2);
  }
}

TEST(Place, AStifferHalfIsNamed) {
  Strokes real;
  Strokes other;
  other.stiffness_N_per_m = halves;
  const auto judgement = judged(real, other, 7410);
  EXPECT_EQ(judgement.verdict, Verdict::noticed);
  EXPECT_THAT(force_of(judgement).what, HasSubstr("stiffer in 5 of"));
  EXPECT_THAT(force_of(judgement).what, HasSubstr("all where x is above"));
}

// The same lump under another hand, deeper, slower, turned, with more noise.
TEST(Place, TheSameLumpIsNotNoticed) {
  std::uint64_t seed = 7500;
  for (const Strokes& hand : {Strokes{}, Strokes{.depth_m = 0.0026}, Strokes{.pace = 0.7}, Strokes{.count = 9},
                              Strokes{.noise_N = 0.02, .tracker_m = 1e-5}}) {
    for (const auto& surface : {lump, halves}) {
      Strokes real;
      real.stiffness_N_per_m = surface;
      Strokes other = hand;
      other.stiffness_N_per_m = surface;
      const auto judgement = judged(real, other, seed += 10);
      EXPECT_NE(judgement.verdict, Verdict::noticed) << seed;
      EXPECT_LT(judgement.d_prime, 0.5) << seed << " " << force_of(judgement).what;
    }
  }
}

// Two hands that explored other places of a lumpy object: nothing is said of what one of them did not touch.
TEST(Place, WhatOneDidNotExploreIsNotJudged) {
  Strokes real{.stiffness_N_per_m = lump};
  Strokes other = real;
  other.to_m = 0.006;
  const auto judgement = judged(real, other, 7600);
  EXPECT_NE(judgement.verdict, Verdict::noticed) << force_of(judgement).what;
  EXPECT_TRUE(std::any_of(judgement.places.force.cells.begin(), judgement.places.force.cells.end(),
                          [](const auto& cell) { return !cell.known && cell.centre_m.x() > 0.008; }));
  EXPECT_THAT(judgement.remarks, ::testing::Contains(HasSubstr("cannot tell")));
}

// The object grows stiffer within a cell, and one hand was on one side of the step alone.
TEST(Place, AStepWithinACellIsNoDifference) {
  for (const double step_m : {0.0074, 0.0092, 0.0108}) {
    Strokes real{.stiffness_N_per_m = [step_m](double x_m) { return x_m < step_m ? 250.0 : 900.0; }};
    Strokes other = real;
    other.from_m = step_m + 0.0005;
    const auto judgement = judged(real, other, 7700);
    EXPECT_NE(judgement.verdict, Verdict::noticed) << step_m << " " << force_of(judgement).what;
  }
}

// The object ends within a cell: nothing is said of where in it.
TEST(Place, AnEdgeIsNoDifferenceAndAMissingHalfIs) {
  const auto ends_at = [](double edge_m) {
    return Strokes{.stiffness_N_per_m = [edge_m](double x_m) { return x_m < edge_m ? 320.0 : 0.0; }};
  };
  for (const double apart_m : {0.0002, 0.001}) {
    const auto judgement = judged(ends_at(0.010), ends_at(0.010 + apart_m), 7720);
    EXPECT_NE(judgement.gives_away, Channel::force) << apart_m << " " << force_of(judgement).what;
  }
  EXPECT_EQ(judged(ends_at(0.010), ends_at(-0.010), 7730).verdict, Verdict::noticed);
}

// By another rate of the recordings, in a turned frame, with another condition before it: the same difference.
TEST(Place, RateFrameAndOrderChangeNothing) {
  Strokes real{.stiffness_N_per_m = lump};
  Strokes other = real;
  other.stiffness_N_per_m = even;
  const double d_prime = judged(real, other, 7800).d_prime;
  for (const double rate_Hz : {120.0, 2000.0}) {
    real.rate_Hz = other.rate_Hz = rate_Hz;
    EXPECT_NEAR(judged(real, other, 7800).d_prime, d_prime, 0.1 * d_prime) << rate_Hz;
  }
  real.rate_Hz = other.rate_Hz = 500.0;
  const Mat3 turn = Eigen::AngleAxisd(0.9, Vec3(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const auto turned = [&turn](Recording recording) {
    for (Vec3& p : recording.motion.p_W_m) p = turn * p;
    for (Vec3& f : recording.f_W_N) f = turn * f;
    return recording;
  };
  const RecordingSource again{"again", [&] { return turned(strokes(real, 7801)); }};
  const auto result = judge_conditions(
      turned(strokes(real, 7800)), {again},
      {{"same", [&] { return turned(strokes(real, 7803)); }}, {"other", [&] { return turned(strokes(other, 7802)); }}},
      turn * Vec3::UnitZ(), {});
  EXPECT_NEAR(result.conditions.back().judgement.d_prime, d_prime, 0.03 * d_prime);
  const auto* strongest = result.conditions.back().judgement.places.force.strongest();
  ASSERT_NE(strongest, nullptr);
  EXPECT_LT((strongest->centre_m - turn * Vec3(0.008, 0.0, 0.0)).norm(),
            result.conditions.back().judgement.places.force.cell_m);
}

const ChannelEvidence& friction_of(const Judgement& judgement) {
  return judgement.channels[static_cast<std::size_t>(Channel::friction)];
}

TEST(Place, MoreFrictionOnTheLeftHalfIsNamed) {
  for (const double depth_m : {0.002, 0.0024}) {
    const auto judgement = judged({.friction = rubbing}, {.depth_m = depth_m, .friction = rubs_left}, 7900);
    EXPECT_EQ(judgement.verdict, Verdict::noticed);
    ASSERT_EQ(judgement.gives_away, Channel::friction);
    EXPECT_THAT(friction_of(judgement).what, HasSubstr("more friction in 5 of"));
    EXPECT_THAT(friction_of(judgement).what, HasSubstr("all where x is below"));
    const auto* strongest = judgement.places.friction.strongest();
    ASSERT_NE(strongest, nullptr);
    EXPECT_LT(strongest->centre_m.x(), 0.0);
    EXPECT_NEAR(strongest->rendered_N / strongest->real_N, 2.0, 0.1);
    EXPECT_NEAR(strongest->real_N, 0.3 * 320.0 * 0.002, 0.15 * 0.3 * 320.0 * 0.002);
  }
}

TEST(Place, TheSameUnevenFrictionIsNotNoticed) {
  std::uint64_t seed = 7950;
  for (const Strokes& hand : {Strokes{}, Strokes{.depth_m = 0.0026}, Strokes{.pace = 0.7}, Strokes{.count = 9},
                              Strokes{.noise_N = 0.02, .tracker_m = 1e-5}, Strokes{.from_m = -0.022, .to_m = 0.025}}) {
    for (const auto& friction : {rubs_left, rubbing}) {
      Strokes other = hand;
      other.friction = friction;
      const auto judgement = judged({.friction = friction}, other, seed += 10);
      EXPECT_NE(judgement.verdict, Verdict::noticed) << seed << " " << friction_of(judgement).what;
      EXPECT_EQ(judgement.places.friction.strongest(), nullptr) << seed << " " << friction_of(judgement).what;
    }
  }
}

// One way, friction hides in what else is met across.
TEST(Place, FrictionOfPlacesThatOneDidNotSlideOverToAndFroIsNotJudged) {
  const auto judgement = judged({.friction = rubs_left}, {.from_m = 0.001, .friction = rubs_left}, 8060);
  EXPECT_NE(judgement.verdict, Verdict::noticed) << friction_of(judgement).what;
  EXPECT_THAT(judgement.remarks, ::testing::Contains(HasSubstr("the friction differs from place to place")));
  const auto one_way = judged({.friction = rubbing}, {.count = 1, .friction = rubs_left}, 8070);
  for (const auto& cell : one_way.places.friction.cells) EXPECT_FALSE(cell.known);
}

TEST(Place, AnEvenObjectHasNoGainOverPlace) {
  const Recording recording = strokes({}, 7700);
  EXPECT_TRUE(judged_process(felt_series(recording, Vec3::UnitZ()), {}).response->gain.coefficients.empty());
  Strokes lumpy{.stiffness_N_per_m = lump};
  const auto process = judged_process(felt_series(strokes(lumpy, 7701), Vec3::UnitZ()), {});
  EXPECT_FALSE(process.response->gain.coefficients.empty());
}

// A place is known to a cell: of cells of 4 mm a tenth of a millimetre is said, and no sign of a zero.
TEST(Place, IsSaidToATenthOfACell) {
  PlaceMap map;
  map.cell_m = 4e-3;
  PlaceDifference strongest;
  strongest.centre_m = Vec3(-0.887e-3, 12.3456e-3, -1.7e-7);
  strongest.real_N = 2.0;
  strongest.rendered_N = 1.0;
  EXPECT_THAT(describe_place(map, strongest), ::testing::HasSubstr("near (-0.9, 12.3, 0) mm"));
}

}  // namespace
}  // namespace touchstone::perception
