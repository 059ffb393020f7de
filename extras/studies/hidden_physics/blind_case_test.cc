// The maker of blind cases against exact answers: its surface's closest point, its laws at rest and in steady motion,
// its instrument's noise, and that a seed makes a case.
#include "hidden_physics/blind_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "harness/base/error.h"
#include "harness/surface/mesh_topology.h"
#include "harness/testing/steps.h"
#include "hidden_physics/weaken.h"
#include "hidden_physics/write_case.h"

namespace touchstone::hidden_physics {
using recording::Recording;

namespace {

TEST(TrueSurface, TheFootOfAPointAboveIsWhereItCameFrom) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    TrueSurface surface;
    surface.half_side_m = scale;
    surface.curvature_per_m = Vec2(-0.3, 0.2) / scale;
    surface.waves.push_back({0.01 * scale, Vec2(2.0, 1.0) / scale, 0.4});
    surface.bumps.push_back({0.02 * scale, Vec2(0.1, -0.2) * scale, 0.3 * scale});
    Random random(4);
    for (int i = 0; i < 200; ++i) {
      const Vec2 xy = scale * Vec2(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8));
      const auto jet = surface.at(xy);
      const Vec3 n = Vec3(-jet.slope.x(), -jet.slope.y(), 1.0).normalized();
      const Vec3 q(xy.x(), xy.y(), jet.h);
      const double height = scale * random.uniform(-0.2, 0.2);
      const auto foot = surface.foot(q + height * n, xy + scale * Vec2(0.05, -0.05));
      EXPECT_NEAR((foot.q_W_m - q).norm(), 0.0, 1e-9 * scale);
      EXPECT_NEAR(foot.distance_m, height, 1e-9 * scale);
    }
  }
}

TEST(TrueSurface, ItsSlabIsClosedAndWithinTheDeviation) {
  TrueSurface surface;
  surface.half_side_m = 0.05;
  surface.curvature_per_m = Vec2(-4.0, -2.0);
  const surface::TriangleMesh mesh = surface.slab(16, 0.02);
  EXPECT_TRUE(make_topology(mesh).closed());
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](std::int32_t i) { return mesh.vertices_W_m[static_cast<std::size_t>(i)]; };
    volume += at(a).dot(at(b).cross(at(c))) / 6.0;
  }
  EXPECT_GT(volume, 0.0);  // outward
  // Chord of a parabola: c h^2 / 8 along each axis, the sum at a square's middle.
  const double step = 0.1 / 16;
  EXPECT_NEAR(surface.deviation_m(surface, 16), (4.0 + 2.0) * step * step / 8.0, 0.3 * 6.0 * step * step / 8.0);
}

class Steady : public ::testing::Test {
 protected:
  // Presses to `depth` at rest, then moves along `v` for a while; the last force.
  static HiddenContact::Forces run(const HiddenPhysics& physics, double depth, const Vec3& v, double seconds) {
    TrueSurface plane;
    HiddenContact contact(plane, physics);
    constexpr double dt = 1e-4;
    HiddenContact::Forces forces;
    Vec3 p(0.0, 0.0, -depth);
    for (const double t : testing::steps(0.0, seconds, dt)) {
      p += dt * v;
      forces = contact.step(t, dt, p, v);
    }
    return forces;
  }
};

TEST_F(Steady, LawsAgreeWithTheirFormulas) {
  HiddenPhysics h;
  h.stiffness_N_per_m = 600.0;
  EXPECT_NEAR(run(h, 2e-3, Vec3::Zero(), 0.01).f_W_N.z(), 1.2, 1e-9);

  HiddenPhysics friction = h;
  friction.mu_static = friction.mu_dynamic = Vec2(0.4, 0.4);
  const auto f = run(friction, 2e-3, Vec3(0.03, 0.04, 0.0), 0.2).f_W_N;
  EXPECT_NEAR(f.x(), -0.4 * 1.2 * 0.6, 1e-4);
  EXPECT_NEAR(f.y(), -0.4 * 1.2 * 0.8, 1e-4);

  HiddenPhysics damped = h;
  damped.damping_N_s_per_m = 9.0;
  const double v = -0.02;
  EXPECT_NEAR(run(damped, 2e-3, Vec3(0, 0, v), 0.1).f_W_N.z(), 600.0 * (2e-3 + 0.02 * 0.1) + 9.0 * 0.02, 2e-3);

  HiddenPhysics relaxing = h;
  relaxing.relaxation_ratio = 0.5;
  relaxing.relaxation_time_s = 0.1;
  // Pressed at once at the first step, then held for two time constants.
  EXPECT_NEAR(run(relaxing, 2e-3, Vec3::Zero(), 0.2).f_W_N.z(), 1.2 + 0.6 * std::exp(-2.0), 2e-3);

  HiddenPhysics hertz = h;
  hertz.exponent = 1.5;
  hertz.reference_depth_m = 1e-3;
  EXPECT_NEAR(run(hertz, 2e-3, Vec3::Zero(), 0.01).f_W_N.z(), 0.6 * std::pow(2.0, 1.5), 1e-9);
}

// Held 2 mm deep until the damper has the whole depth, then let go for half a time constant: the surface is back at
// ratio / (1 + ratio) of the depth at once and goes on with the time constant's (1 + ratio)-fold. A tip that returns
// feels it there and not before.
TEST_F(Steady, ASurfaceThatRelaxedIsTouchedWhereItIsByThen) {
  HiddenPhysics h;
  h.stiffness_N_per_m = 600.0;
  h.relaxation_ratio = 0.5;
  h.relaxation_time_s = 0.1;
  TrueSurface plane;
  constexpr double dt = 1e-4;
  const double surface = 2e-3 / 3.0 * std::exp(-0.5 / 1.5);
  for (const double beside : {-2e-6, 2e-6}) {
    HiddenContact contact(plane, h);
    for (const double t : testing::steps(0.0, 2.0, dt)) contact.step(t, dt, Vec3(0, 0, -2e-3), Vec3::Zero());
    for (const double t : testing::steps(2.0, 2.05, dt)) contact.step(t, dt, Vec3(0, 0, 1e-3), Vec3::Zero());
    const auto back = contact.step(2.05, dt, Vec3(0, 0, -surface - beside), Vec3::Zero());
    EXPECT_NEAR(back.f_W_N.z(), std::max(0.0, 600.0 * 1.5 * beside), 600.0 * 1e-6) << beside;
  }
}

TEST_F(Steady, EffectsThatNoLibraryHasAgreeWithTheirFormulas) {
  HiddenPhysics h;
  h.stiffness_N_per_m = 600.0;
  HiddenPhysics hysteresis = h;
  hysteresis.outside.hysteresis_N = 0.4;
  hysteresis.outside.hysteresis_m = 1e-3;
  // Over 20 mm the state comes to its end: f = -F v / |v|.
  EXPECT_NEAR(run(hysteresis, 2e-3, Vec3(0.1, 0.0, 0.0), 0.2).f_W_N.x(), -0.4, 1e-6);
  HiddenPhysics tissue = h;
  tissue.outside.tissue_N = 0.7;
  tissue.outside.tissue_from_m = 1e-3;
  EXPECT_NEAR(run(tissue, 2e-3, Vec3::Zero(), 0.01).f_W_N.z(), 1.2 + 0.7, 1e-9);
  HiddenPhysics play = h;
  play.outside.play_m = 1e-4;
  // The tip stays behind the tool that presses: k (d - b).
  EXPECT_NEAR(run(play, 1e-3, Vec3(0.0, 0.0, -0.01), 0.1).f_W_N.z(), 600.0 * (2e-3 - 1e-4), 2e-3);
  HiddenPhysics leash = h;
  leash.outside.leash_N_per_m = 50.0;
  leash.outside.leash_m = 0.01;
  leash.outside.leash_end_W_m = Vec3(0.03, 0.0, -2e-3);
  EXPECT_NEAR(run(leash, 2e-3, Vec3::Zero(), 0.01).f_W_N.x(), 50.0 * 0.02, 1e-9);
  HiddenPhysics cogging = h;
  cogging.outside.cogging_N = 0.3;
  cogging.outside.cogging_length_m = 8e-3;
  cogging.outside.cogging_along_W = Vec3::UnitZ();
  // A quarter of a length: sin(-pi / 2) + 0.2 sin(-pi).
  EXPECT_NEAR(run(cogging, 2e-3, Vec3::Zero(), 0.01).f_W_N.z(), 1.2 - 0.3, 1e-9);
}

TEST(BlindCase, ASeedMakesACaseAndOpaqueNamesDiffer) {
  std::set<std::string> names;
  for (const std::string& set : blind_sets()) {
    for (std::size_t i = 0; i < 6; ++i) {
      const BlindCase once = plan_case(set, i, 9);
      const BlindCase again = plan_case(set, i, 9);
      EXPECT_EQ(answers_to_json({once}, 9), answers_to_json({again}, 9));
      names.insert(once.id);
    }
  }
  EXPECT_EQ(names.size(), 6 * blind_sets().size());
  EXPECT_THROW(plan_case("nonsense", 0, 1), UsageError);
}

TEST(BlindCase, RecordsForcesThatFollowTheHandAndStayFinite) {
  for (const std::string& set : blind_sets()) {
    BlindCase plan = plan_case(set, 3, 5);
    plan.train.duration_s = 3.0;
    const Recording recording = record(plan, false);
    ASSERT_EQ(recording.size(), 750U);
    double largest = 0.0;
    for (std::size_t i = 0; i < recording.size(); ++i) {
      ASSERT_TRUE(recording.f_W_N[i].allFinite() && recording.motion.p_W_m[i].allFinite()) << set;
      largest = std::max(largest, recording.f_W_N[i].norm());
    }
    EXPECT_GT(largest, 0.3) << set;
    EXPECT_LT(largest, 50.0) << set;
  }
}

TEST(BlindCase, AnswersNameTheAlikePairAsAList) {
  const BlindCase plan = plan_case("cannot-tell", 0, 1);
  const auto answers = nlohmann::json::parse(answers_to_json({plan}, 1));
  EXPECT_EQ(answers["cases"][0]["ambiguous"], nlohmann::json::parse(R"([["tool-weight", "force-bias"]])"));
}

TEST(BlindCase, AWeakenedEffectIsSmallerInTheRecordingAndInTheAnswer) {
  for (std::size_t index = 0; index < 21; ++index) {
    const BlindCase whole = plan_case("one", index, 11);
    BlindCase weak = whole;
    weaken(weak, 1e-6);
    BlindCase none = whole;
    weaken(none, 0.0);
    const Recording as_planned = record(whole, false);
    const Recording weakened = record(weak, false);
    const Recording without = record(none, false);
    // A registration moves the positions, all others the forces.
    const double stiffness = whole.physics.stiffness_N_per_m;
    const auto apart = [&](const Recording& a) {
      double sum = 0.0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        sum += (a.f_W_N[i] - without.f_W_N[i]).squaredNorm() +
               (stiffness * (a.motion.p_W_m[i] - without.motion.p_W_m[i])).squaredNorm();
      }
      return sum;
    };
    const double full = apart(as_planned);
    const double left = apart(weakened);
    EXPECT_GT(full, 0.0) << whole.effects[0].name;
    // Rounding of the sensor's steps, where a reading lay on one.
    EXPECT_LT(left, 1e-3 * full) << whole.effects[0].name;
    std::size_t changed = 0;
    for (const auto& [name, value] : whole.effects[0].parameters) {
      if (weak.effects[0].parameters.at(name) != value) ++changed;
    }
    EXPECT_GT(changed, 0U) << whole.effects[0].name;
  }
}

}  // namespace
}  // namespace touchstone::hidden_physics
