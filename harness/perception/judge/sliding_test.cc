#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "harness/perception/judge/identical_pairs_for_test.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

constexpr double degree = std::numbers::pi / 180.0;

JudgeOptions friction_alone() {
  JudgeOptions options;
  options.without = {Channel::vibration, Channel::transient};
  return options;
}

Judgement rubbed(const PlantedProcess& real, const PlantedProcess& other, const JudgeOptions& options = {},
                 const Mat3& turn = Mat3::Identity()) {
  const auto turned = [&turn](Recording recording) {
    for (Vec3& p : recording.motion.p_W_m) p = turn * p;
    for (Vec3& f : recording.f_W_N) f = turn * f;
    return recording;
  };
  const RecordingSource again{"again", [&] { return turned(planted(real, 12)); }};
  const RecordingSource condition{"condition", [&] { return turned(planted(other, 13)); }};
  return judge_conditions(turned(planted(real, 11)), {again}, {condition}, turn * Vec3::UnitZ(), options)
      .conditions[0]
      .judgement;
}

// Twice the friction is told in whatever direction the strokes go.
TEST(Sliding, FrictionIsToldInEveryDirectionOfTheStrokes) {
  const PlantedProcess real{.friction = 0.25, .slides = true};
  const PlantedProcess rough{.friction = 0.5, .slides = true};
  const double along = rubbed(real, rough, friction_alone()).d_prime;
  EXPECT_GT(along, 2.0);
  for (const double degrees : {10.0, 27.0, 45.0, 62.0, 80.0, 135.0}) {
    PlantedProcess a = real;
    PlantedProcess b = rough;
    a.slide_rad = b.slide_rad = degrees * degree;
    const auto judgement = rubbed(a, b, friction_alone());
    EXPECT_EQ(judgement.verdict, Verdict::noticed) << degrees;
    EXPECT_NEAR(judgement.d_prime, along, 0.05 * along) << degrees;
  }
}

TEST(Sliding, ATurnOfTheWorldIsNoDifference) {
  const PlantedProcess real{.friction = 0.25, .slides = true, .slide_rad = 0.4};
  const PlantedProcess rough{.friction = 0.4, .slides = true, .slide_rad = 0.4};
  const double upright = rubbed(real, rough).d_prime;
  for (const double degrees : {20.0, 35.0, 111.0}) {
    const Mat3 turn = Eigen::AngleAxisd(degrees * degree, Vec3(1.0, 0.7, -0.3).normalized()).toRotationMatrix();
    EXPECT_NEAR(rubbed(real, rough, {}, turn).d_prime, upright, 1e-3 * upright) << degrees;
  }
}

// Two strokes one way and one back leave friction in the mean force; it is no direction of pressing.
TEST(Sliding, TheDirectionOfPressingIsNotThatOfTheFriction) {
  for (const double mu : {0.0, 0.3, 0.8}) {
    Recording recording = planted({.friction = mu, .slides = true}, 5);
    // Without every other way back of the strokes.
    Recording kept;
    kept.source = recording.source;
    for (std::size_t i = 10; i + 10 < recording.size(); ++i) {
      const bool back = recording.motion.p_W_m[i + 10].x() < recording.motion.p_W_m[i - 10].x();
      if (back && i % 2000 < 1000) continue;
      kept.motion.t_s.push_back(0.001 * static_cast<double>(kept.size()));
      kept.motion.p_W_m.push_back(recording.motion.p_W_m[i]);
      kept.f_W_N.push_back(recording.f_W_N[i]);
    }
    const auto off = [](const Vec3& direction) { return std::acos(std::min(1.0, direction.z())); };
    EXPECT_LT(off(pressing_direction(kept)), 0.25 * off(press_direction(kept)) + 0.1 * degree) << mu;
    EXPECT_GE(off(press_direction(kept)), mu > 0.0 ? 2.0 * degree : 0.0) << mu;
  }
}

// Another load is another hand.
TEST(Sliding, TheHandIsNotJudged) {
  const PlantedProcess real{.friction = 0.3, .slides = true};
  for (const auto& [load, pace] : {std::pair{0.5, 1.0}, std::pair{1.3, 1.0}, std::pair{1.0, 0.7}}) {
    PlantedProcess hand = real;
    hand.load = load;
    hand.pace = pace;
    const auto judgement = rubbed(real, hand);
    EXPECT_NE(judgement.verdict, Verdict::noticed) << load << " " << pace << ": " << judgement.d_prime;
  }
}

// A hand that lands, rests, slides to and fro at one depth and lifts: depths above the strokes are never slid at.
struct Ridges {
  double force_N = 0.0;
  double width_m = 0.0007;
};
Recording stroked(double mu, double depth_m, double stroke_s, std::uint64_t seed, const Ridges& ridges = {}) {
  constexpr double k_N_per_m = 620.0;
  constexpr double stroke_m = 0.03;
  constexpr double above_m = 0.004;
  Random random(seed);
  Recording recording;
  recording.source = "stroked";
  const double move_s = 0.35;
  const double press_s = 2.0 * move_s + 4.0 * stroke_s + 0.3;
  double before_m = 0.0;
  const auto eased = [](double share) { return 0.5 - 0.5 * std::cos(std::numbers::pi * std::clamp(share, 0.0, 1.0)); };
  for (int press = 0; press < 6; ++press) {
    const double own_depth_m = depth_m * random.uniform(0.96, 1.04);
    for (double s = 0.0; s < press_s; s += 0.001) {
      const double slid = std::clamp((s - move_s) / stroke_s, 0.0, 4.0);
      const double way = std::fmod(slid, 2.0);
      const double x_m = stroke_m * (way < 1.0 ? eased(way) : 1.0 - eased(way - 1.0));
      const double down = eased(s / move_s) - eased((s - move_s - 4.0 * stroke_s) / move_s);
      const double depth = (own_depth_m + above_m) * down - above_m;
      const double speed = (x_m - before_m) / 0.001;
      before_m = x_m;
      const double load_N = k_N_per_m * std::max(0.0, depth);
      const auto noise = [&random](double sigma) {
        const double x = random.normal();
        const double y = random.normal();
        return Vec3(sigma * Vec3(x, y, random.normal()));
      };
      recording.motion.t_s.push_back(0.001 * static_cast<double>(recording.motion.t_s.size()));
      recording.motion.p_W_m.push_back(Vec3(x_m, 0.0, -depth) + noise(3e-6));
      const double texture_N =
          load_N > 0.0 ? ridges.force_N * std::sin(2.0 * std::numbers::pi * x_m / ridges.width_m) : 0.0;
      recording.f_W_N.push_back(Vec3(-mu * load_N * std::tanh(speed / 0.003), 0.0, load_N + texture_N) + noise(0.004));
    }
  }
  return recording;
}

// Where a depth was not slid at, no friction is made up for it; one load and another tell it by Amontons' law.
TEST(Sliding, FrictionIsComparedWhereBothSlid) {
  int noticed = 0;
  for (std::uint64_t seed = 500; seed < 560; seed += 10) {
    const Recording real = stroked(0.35, 0.003, 0.5, seed);
    const RecordingSource again{"again", [&] { return stroked(0.35, 0.003, 0.5, seed + 1); }};
    const RecordingSource same{"same", [&] { return stroked(0.35, 0.003, 0.5, seed + 2); }};
    const RecordingSource deeper{"deeper", [&] { return stroked(0.35, 0.0038, 0.5, seed + 3); }};
    const RecordingSource slower{"slower", [&] { return stroked(0.35, 0.0026, 0.65, seed + 4); }};
    const RecordingSource rough{"rough", [&] { return stroked(0.35 * 1.44, 0.0031, 0.5, seed + 5); }};
    const auto judged = judge_conditions(real, {again}, {same, deeper, slower, rough}, Vec3::UnitZ(), {});
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& judgement = judged.conditions[c].judgement;
      const auto& friction = judgement.channels[static_cast<std::size_t>(Channel::friction)];
      noticed += judgement.verdict == Verdict::noticed ? 1 : 0;
      EXPECT_TRUE(friction.known) << judged.conditions[c].name;
      EXPECT_LT(friction.jnd, 0.3) << judged.conditions[c].name << " " << seed << ": " << friction.what;
    }
    // Twice 20 %.
    const auto& friction = judged.conditions[3].judgement.channels[static_cast<std::size_t>(Channel::friction)];
    EXPECT_NEAR(friction.jnd, 2.0, 0.3) << seed << ": " << friction.what;
    EXPECT_LT(friction.standard_error, 0.4) << seed;
    EXPECT_EQ(judged.conditions[3].judgement.verdict, Verdict::noticed) << seed;
  }
  EXPECT_LE(noticed, 1);
}

// A ridged surface vibrates in proportion to the speed of the stroke.
TEST(Sliding, ATextureIsComparedAtLikeSpeeds) {
  const Ridges ridges{.force_N = 0.02};
  for (std::uint64_t seed = 700; seed < 740; seed += 10) {
    const Recording real = stroked(0.2, 0.003, 0.5, seed, ridges);
    const RecordingSource again{"again", [&] { return stroked(0.2, 0.003, 0.5, seed + 1, ridges); }};
    const RecordingSource slower{"slower", [&] { return stroked(0.2, 0.003, 0.85, seed + 2, ridges); }};
    const RecordingSource deeper{"deeper", [&] { return stroked(0.2, 0.0042, 0.4, seed + 3, ridges); }};
    const RecordingSource smooth{"smooth", [&] { return stroked(0.2, 0.003, 0.55, seed + 4); }};
    const RecordingSource coarse{
        "coarse", [&] { return stroked(0.2, 0.003, 0.5, seed + 5, {.force_N = 0.02, .width_m = 0.0018}); }};
    const auto judged = judge_conditions(real, {again}, {slower, deeper, smooth, coarse}, Vec3::UnitZ(), {});
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_NE(judged.conditions[c].judgement.verdict, Verdict::noticed)
          << judged.conditions[c].name << " " << seed << ": " << judged.conditions[c].judgement.d_prime;
    }
    for (std::size_t c = 2; c < 4; ++c) {
      EXPECT_EQ(judged.conditions[c].judgement.verdict, Verdict::noticed) << judged.conditions[c].name << " " << seed;
      EXPECT_EQ(judged.conditions[c].judgement.gives_away, Channel::vibration) << judged.conditions[c].name;
    }
  }
}

TEST(Sliding, SaysAtWhichSpeedsATextureWouldTell) {
  const Ridges ridges{.force_N = 0.02};
  const RecordingSource slow{"slow", [&] { return stroked(0.2, 0.003, 2.5, 801); }};
  const auto judged = judge_conditions(stroked(0.2, 0.003, 0.4, 800, ridges), {}, {slow}, Vec3::UnitZ(), {});
  EXPECT_THAT(judged.conditions[0].judgement.open, ::testing::HasSubstr("slide at like speeds and loads"));
}

}  // namespace
}  // namespace touchstone::perception
