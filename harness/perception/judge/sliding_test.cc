#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/perception/judge/identical_pairs_for_test.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

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
    a.slide_rad = b.slide_rad = degrees * kDegree;
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
    const Mat3 turn = Eigen::AngleAxisd(degrees * kDegree, Vec3(1.0, 0.7, -0.3).normalized()).toRotationMatrix();
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
    EXPECT_LT(off(pressing_direction(kept)), 0.25 * off(press_direction(kept)) + 0.1 * kDegree) << mu;
    EXPECT_GE(off(press_direction(kept)), mu > 0.0 ? 2.0 * kDegree : 0.0) << mu;
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

}  // namespace
}  // namespace touchstone::perception
