// A ball and a slope under hands that press along z: the same object is one, a stiffer one another.
#include "harness/perception/judge/surface_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "harness/base/random.h"
#include "harness/perception/judge/identical_pairs_for_test.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

constexpr double ball_m = 0.09;

struct Contact {
  Vec3 normal = Vec3::UnitZ();
  double depth_m = 0.0;
};
using Object = std::function<Contact(const Vec3&)>;

// Its top is at the origin.
Contact ball(const Vec3& p) {
  const Vec3 from_centre = p + Vec3(0.0, 0.0, ball_m);
  return {from_centre.normalized(), ball_m - from_centre.norm()};
}

Contact slope(const Vec3& p) {
  const Vec3 normal = Vec3(-0.25, 0.1, 1.0).normalized();
  return {normal, -normal.dot(p)};
}

struct Hand {
  double depth_m = 0.004;
  double pace = 1.0;
  double reach_m = 0.02;
};

// Landings, and loops over the object at about one height.
Recording looped(const Object& object, double k_N_per_m, const Hand& hand, std::uint64_t seed) {
  Random random(seed);
  Recording recording;
  recording.source = "looped";
  const double phase = random.uniform(0.0, 6.0);
  double t = 0.0;
  for (int press = 0; press < 5; ++press) {
    const double depth_m = hand.depth_m * random.uniform(0.85, 1.15);
    for (double s = 0.0; s < 2.6; s += 0.002, t += 0.002) {
      const double down = 0.5 - 0.5 * std::cos(std::numbers::pi * std::min({1.0, s / 0.4, (2.6 - s) / 0.4}));
      const double x_m = hand.reach_m * std::sin(4.0 * hand.pace * t + phase);
      const double y_m = 0.7 * hand.reach_m * std::sin(6.1 * hand.pace * t);
      const Vec3 p(x_m, y_m, 0.006 - (depth_m + 0.006) * down);
      const Contact contact = object(p);
      const auto noise = [&random](double sigma) {
        const double a = random.normal();
        const double b = random.normal();
        return Vec3(sigma * Vec3(a, b, random.normal()));
      };
      recording.motion.t_s.push_back(t);
      recording.motion.p_W_m.push_back(p + noise(3e-6));
      recording.f_W_N.push_back(k_N_per_m * std::max(0.0, contact.depth_m) * contact.normal + noise(0.004));
    }
  }
  return recording;
}

TEST(SurfaceShape, IsTheObjectsOwnAndAFlatOneHasNone) {
  const auto on_ball = surface_shape(felt_series(looped(ball, 450.0, {}, 3), Vec3::UnitZ()), 0.12);
  ASSERT_TRUE(on_ball);
  for (const double x_m : {-0.015, 0.004, 0.012}) {
    // Depth at which the ball is met, beside that at its top.
    EXPECT_NEAR(on_ball->at(x_m, 0.005).height_m - on_ball->at(0.0, 0.0).height_m,
                ball_m - std::sqrt(ball_m * ball_m - x_m * x_m - 25e-6), 2e-4);
  }
  const auto on_slope = surface_shape(felt_series(looped(slope, 450.0, {}, 4), Vec3::UnitZ()), 0.12);
  ASSERT_TRUE(on_slope);
  EXPECT_NEAR(on_slope->at(0.003, 0.002).slope[0], -0.25, 0.005);
  EXPECT_NEAR(on_slope->at(0.003, 0.002).slope[1], 0.1, 0.005);
  // Strokes along x alone say nothing of a slope along y.
  const auto ridge = [](const Vec3& p) {
    const Vec3 normal = Vec3(-0.25, 0.0, 1.0).normalized();
    return Contact{normal, -normal.dot(p)};
  };
  Recording strokes = looped(ridge, 450.0, {}, 7);
  for (Vec3& p : strokes.motion.p_W_m) p.y() *= 1e-4;
  const auto along_x = surface_shape(felt_series(strokes, Vec3::UnitZ()), 0.12);
  ASSERT_TRUE(along_x);
  EXPECT_NEAR(along_x->at(0.003, 0.0).slope[0], -0.25, 0.005);
  EXPECT_NEAR(along_x->at(0.003, 0.0).slope[1], 0.0, 0.005);
  for (const PlantedProcess& flat : kinds_of_surface())
    EXPECT_FALSE(surface_shape(felt_series(planted(flat, 5), Vec3::UnitZ()), 0.12)) << flat.k_N_per_m;
  const auto lumpy = [](const Vec3& p) {
    return Contact{Vec3::UnitZ(), -p.z() * (1.0 + 0.8 * std::exp(-p.squaredNorm() / 1e-4))};
  };
  EXPECT_FALSE(surface_shape(felt_series(looped(lumpy, 450.0, {}, 6), Vec3::UnitZ()), 0.12));
}

TEST(SurfaceShape, OneCurvedObjectIsNotNoticedAndASofterOneIs) {
  const Hand other{.depth_m = 0.005, .pace = 1.2, .reach_m = 0.016};
  for (const Object& object : {Object(ball), Object(slope)}) {
    const RecordingSource again{"again", [&] { return looped(object, 450.0, {}, 11); }};
    const RecordingSource same{"same", [&] { return looped(object, 450.0, {}, 12); }};
    const RecordingSource hand{"hand", [&] { return looped(object, 450.0, other, 13); }};
    const RecordingSource soft{"soft", [&] { return looped(object, 450.0 / 1.22 / 1.22 / 1.22, other, 14); }};
    const auto judged =
        judge_conditions(looped(object, 450.0, {}, 10), {again}, {same, hand, soft}, Vec3::UnitZ(), {}).conditions;
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_NE(judged[c].judgement.verdict, Verdict::noticed) << judged[c].name << " " << judged[c].judgement.d_prime;
      EXPECT_LT(judged[c].judgement.channels[static_cast<std::size_t>(Channel::stiffness)].jnd, 0.3);
    }
    EXPECT_EQ(judged[2].judgement.verdict, Verdict::noticed);
    EXPECT_NEAR(judged[2].judgement.channels[static_cast<std::size_t>(Channel::stiffness)].jnd, 3.0, 0.4);
  }
}

}  // namespace
}  // namespace touchstone::perception
