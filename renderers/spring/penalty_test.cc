// The penalty renderer against exact answers, and its known limits pinned: each test named PinnedLimit... expects the
// wrong answer and fails when the right one comes, so that a declared limit that has gone is noticed.
#include "renderers/spring/penalty.h"

#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "renderers/posed_surface_for_test.h"
#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::renderers {
using rendering::Ability;
using rendering::StepResult;
using surface::TriangleMesh;

namespace {

constexpr double wall_stiffness = 500.0;
constexpr double eps = std::numeric_limits<double>::epsilon();

std::unique_ptr<rendering::Renderer> penalty(std::shared_ptr<const surface::Surface> surface, double stiffness,
                                             double radius_m = 0.0) {
  return make_renderer(model_of("penalty", {{"stiffness_N_per_m", stiffness}, {"tip_radius_m", radius_m}}),
                       std::move(surface));
}

TEST(Penalty, IsTheExactContactOfEveryAnalyticSurfaceAtEveryScale) {
  for (const auto& entry : synthetic::surface_catalogue()) {
    for (const double scale : unit_scales()) {
      const auto surface = posed(entry.name, scale);
      for (const double radius : {0.0, 1e-3}) {
        const auto renderer = penalty(surface, wall_stiffness / scale, scale * radius);
        Hand hand(*renderer);
        Random random(1);
        const Box3 box = surface->bounds();
        int touching = 0;
        for (int i = 0; i < 300; ++i) {
          const Vec3 anywhere = box.center() + 0.6 * box.sizes().norm() * random.uniform(-1, 1) * random.direction();
          const surface::SurfacePoint foot = surface->closest(anywhere);
          const Vec3 tip = foot.p_W_m + scale * random.uniform(-5e-4, 2e-3) * foot.n_W;
          const StepResult result = hand.to(tip);
          const surface::SurfacePoint nearest = surface->closest(tip);
          ASSERT_EQ(result.contact, nearest.signed_distance_m < scale * radius) << entry.name;
          if (!result.contact) {
            ASSERT_EQ(result.f_W_N, Vec3::Zero());
            continue;
          }
          ++touching;
          const double depth = scale * radius - nearest.signed_distance_m;
          // The way out is known to eps times where the tip is over how far the surface is.
          const double turned = 64.0 * eps * scale * 0.2 / std::max(nearest.distance_m, 1e-300);
          ASSERT_NEAR(result.depth_m, depth, 64.0 * eps * scale);
          ASSERT_NEAR(result.f_W_N.norm(), wall_stiffness / scale * depth, wall_stiffness * 64.0 * eps) << entry.name;
          ASSERT_GE(result.n_W.dot(nearest.n_W), 0.0 - turned) << entry.name << ": it pushes out, never in";
          ASSERT_LE(std::abs(surface->closest(result.contact_W_m).distance_m - scale * radius), scale * 2e-3)
              << entry.name;
        }
        EXPECT_GT(touching, 30) << entry.name;
      }
    }
  }
}

// In the middle of a plate both sides are equally close: the tip is pushed out on the side that it came through.
TEST(Penalty, OfEquallyCloseSidesItTakesTheOneWhereItWas) {
  const double half = 0.003;
  for (const double scale : unit_scales()) {
    TriangleMesh plate = testing::cube(1.0);
    const Box3 box = make_embree_surface(plate)->bounds();
    for (Vec3& v : plate.vertices_W_m) {
      v = 2.0 * (v - box.center()).cwiseQuotient(box.sizes());  // from -1 to 1
      v = scale * v.cwiseProduct(Vec3(0.02, 0.03, half));
    }
    const auto surface = make_embree_surface(plate);
    for (const std::string name : {"penalty", "spring-linear"}) {
      for (const double side : {1.0, -1.0}) {
        const auto renderer = make_renderer(model_of(name, {{"stiffness_N_per_m", wall_stiffness / scale}}), surface);
        Hand hand(*renderer);
        const auto at = [&](double z) { return Vec3(scale * Vec3(0.0013, 0.0021, side * z)); };
        for (int i = 0; i < 40; ++i) hand.to(at(half + 0.001 - 1e-4 * i));
        for (const double z : {1e-9, 0.0, 0.0}) {
          const Vec3 force = hand.to(at(z)).f_W_N;
          EXPECT_NEAR(force.z(), side * wall_stiffness * (half - z), 1e-9) << name << " x " << scale;
        }
        // Past the middle the far side is closer.
        EXPECT_LT(side * hand.to(at(-1e-9)).f_W_N.z(), 0.0) << name << " x " << scale;
        EXPECT_LT(side * hand.to(at(0.0)).f_W_N.z(), 0.0) << name << " x " << scale;
      }
    }
  }
}

// Beside an open sheet, above, in and below its plane.
TEST(Penalty, BeyondTheRimOfASheetIsNoInside) {
  for (const double scale : unit_scales()) {
    TriangleMesh sheet;
    sheet.vertices_W_m = {{0, 0, 0}, {0.03, 0, 0}, {0.03, 0.02, 0}, {0, 0.02, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    const Quat turn = awkward_rotation();
    const auto surface = make_embree_surface(surface::moved(sheet, turn, Vec3::Zero(), scale));
    for (const std::string name : {"penalty", "spring-linear", "spring-quadratic"}) {
      const auto renderer = make_renderer(model_of(name, {}), surface);
      Hand hand(*renderer);
      for (const Vec3& beside : {Vec3(-0.005, 0.01, 0), Vec3(0.034, 0.007, 0), Vec3(-0.003, -0.004, 0)}) {
        for (const double z : {1e-3, 1e-12, 0.0, -1e-12, -1e-3}) {
          const StepResult result = hand.to(turn * (scale * (beside + Vec3(0, 0, z))));
          EXPECT_FALSE(result.contact) << name << " x " << scale << " z " << z;
          EXPECT_EQ(result.f_W_N, Vec3::Zero()) << name << " x " << scale << " z " << z;
        }
      }
      EXPECT_TRUE(hand.to(turn * (scale * Vec3(0.01, 0.01, -1e-3))).contact) << name;
    }
  }
}

TEST(Penalty, IsTheGodObjectOfASphereToRounding) {
  for (const double scale : unit_scales()) {
    for (const double radius : {0.0, 2e-3}) {
      const auto surface = posed("sphere", scale);
      const auto renderer = penalty(surface, wall_stiffness / scale, scale * radius);
      Hand hand(*renderer);
      Random random(2);
      for (int i = 0; i < 500; ++i) {
        const Vec3 tip = surface->bounds().center() + scale * random.uniform(0.02, 0.034) * random.direction();
        const auto exact = synthetic::exact_contact(*surface, tip, wall_stiffness / scale, scale * radius);
        const StepResult result = hand.to(tip);
        ASSERT_EQ(result.contact, exact.contact);
        ASSERT_LE((result.f_W_N - exact.f_W_N).norm(), wall_stiffness * 64.0 * eps * 0.1 * 4.0);
        ASSERT_LE((result.contact_W_m - exact.proxy_W_m).norm(), scale * 64.0 * eps * 0.1);
      }
    }
  }
}

TEST(Penalty, PowersOfTwoOfTheUnitChangeNoBit) {
  const TriangleMesh mesh = synthetic::make_mesh("duck", {}, 3000).mesh;
  const auto run = [&](double scale) {
    const auto renderer = penalty(make_embree_surface(surface::moved(mesh, Quat::Identity(), Vec3::Zero(), scale)),
                                  512.0 / scale, 0.0009765625 * scale);
    Hand hand(*renderer);
    Random random(4);
    std::vector<Vec3> forces;
    for (int i = 0; i < 2000; ++i) forces.push_back(hand.to(scale * 0.045 * random.direction()).f_W_N);
    return forces;
  };
  const auto one = run(1.0);
  EXPECT_GT(std::count_if(one.begin(), one.end(), [](const Vec3& f) { return !f.isZero(0.0); }), 300);
  for (const double scale : {std::ldexp(1.0, -20), 0.5, 1024.0}) EXPECT_EQ(run(scale), one) << scale;
}

TEST(Penalty, PinnedLimitItPopsThroughThinShells) {
  for (const double thickness : {2e-3, 2e-4, 5e-5}) {
    for (const double scale : unit_scales()) {
      const synthetic::ParameterOverrides overrides{{"thickness_m", thickness * scale}, {"half_side_m", 0.05 * scale}};
      const std::shared_ptr<const synthetic::AnalyticSurface> shell = synthetic::make_surface("thin-shell", overrides);
      const std::vector<std::shared_ptr<const surface::Surface>> surfaces{
          shell, make_embree_surface(synthetic::make_mesh("thin-shell", overrides, 200).mesh)};
      for (const auto& surface : surfaces) {
        const auto renderer = penalty(surface, wall_stiffness / scale);
        Hand hand(*renderer);
        const auto at = [&](double depth) { return hand.to(scale * Vec3(0.0013, 0.0021, -depth)); };
        EXPECT_FALSE(at(-1e-4).contact);
        EXPECT_GT(at(0.4 * thickness).f_W_N.z(), 0.0) << "above the middle it pushes back up";
        EXPECT_LT(at(0.6 * thickness).f_W_N.z(), 0.0) << "known limit: below the middle it pushes out below";
        EXPECT_FALSE(at(1.1 * thickness).contact) << "known limit: and then the tip is free below the shell";
        EXPECT_NE(find_limitation(penalty_entry().cannot, Ability::thin_shells), nullptr);
      }
    }
  }
}

TEST(Penalty, PinnedLimitAJumpThroughABodyIsNotSeen) {
  const auto renderer = penalty(make_embree_surface(testing::cube(0.02)), wall_stiffness);
  Hand hand(*renderer);
  EXPECT_FALSE(hand.to({0.001, 0.002, 0.03}).contact);
  EXPECT_FALSE(hand.to({0.001, 0.002, -0.03}).contact) << "known limit";
  EXPECT_NE(find_limitation(penalty_entry().cannot, Ability::large_jumps), nullptr);
}

TEST(Penalty, PinnedLimitTheForceJumpsWhereTwoFacesAreEquallyNear) {
  const auto renderer = penalty(make_embree_surface(testing::cube(0.02)), wall_stiffness);
  Hand hand(*renderer);
  const Vec3 before = hand.to({0.012 - 1e-9, 0.001, 0.012}).f_W_N;
  const Vec3 after = hand.to({0.012 + 1e-9, 0.001, 0.012}).f_W_N;
  EXPECT_GT((after - before).norm(), wall_stiffness * 0.008) << "known limit";
  EXPECT_NE(find_limitation(penalty_entry().cannot, Ability::continuous_force), nullptr);
}

TEST(Penalty, PinnedLimitABallInAGrooveLeansOnOneWallOnly) {
  const std::shared_ptr<const synthetic::AnalyticSurface> groove =
      synthetic::make_surface("v-groove", {{"opening_rad", 1.2}, {"depth_m", 0.005}});
  const double radius = 1e-3;
  const auto renderer = penalty(groove, wall_stiffness, radius);
  Hand hand(*renderer);
  const StepResult result = hand.to({0.0001, 0.003, -0.005 + 1.2 * radius});
  ASSERT_TRUE(result.contact);
  EXPECT_LT(groove->signed_distance(result.contact_W_m), 0.99 * radius) << "known limit: the ball is inside a wall";
  EXPECT_NE(find_limitation(penalty_entry().cannot, Ability::surface_contact), nullptr);
}

}  // namespace
}  // namespace touchstone::renderers
