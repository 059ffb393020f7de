// The implicit renderer: against exact answers, as a reference for the god-object, and its known limits pinned (tests
// named PinnedLimit... expect the wrong answer and fail when the right one comes).
#include "renderers/field/implicit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "harness/base/random.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/field/signed_field.h"
#include "renderers/hand_for_test.h"
#include "renderers/posed_surface_for_test.h"
#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::renderers {
using rendering::StepResult;
using surface::Surface;

namespace {

constexpr double wall_stiffness = 500.0;

std::unique_ptr<rendering::Renderer> implicit(std::shared_ptr<const Surface> surface, double stiffness,
                                              double radius_m = 0.0, double resolution = 64.0) {
  return make_renderer(
      model_of("implicit", {{"stiffness_N_per_m", stiffness}, {"tip_radius_m", radius_m}, {"resolution", resolution}}),
      std::move(surface));
}

// A stroke over the surface, at most `depth` deep, that begins free: tips at `scale`.
std::vector<Vec3> stroke(const Surface& surface, double scale, double radius, double depth, int steps) {
  Random random(7);
  const Box3 box = surface.bounds();
  surface::SurfacePoint foot = surface.closest(box.center() + Vec3(0.1, 0.07, 1.0) * box.sizes().norm());
  Vec3 along = random.direction();
  std::vector<Vec3> tips{foot.p_W_m + (radius + 1e-3 * scale) * foot.n_W};
  for (int i = 0; i < steps; ++i) {
    if (i % 60 == 0) along = random.direction();
    tips.push_back(foot.p_W_m + (radius - depth * std::min(1.0, i / 40.0)) * foot.n_W);
    const Vec3 next = foot.p_W_m + 5e-5 * scale * (along - along.dot(foot.n_W) * foot.n_W);
    foot = surface.closest(next);
  }
  return tips;
}

TEST(Implicit, IsTheExactContactOfSmoothAnalyticSurfacesAtEveryScale) {
  for (const char* name : {"plane", "sphere", "torus", "saddle", "gauss", "bumpy", "duck"}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      for (const double radius : {0.0, 1e-3}) {
        const auto surface = posed(name, scale);
        const auto renderer = implicit(surface, wall_stiffness / scale, scale * radius);
        Hand hand(*renderer);
        double worst = 0.0;
        for (const Vec3& tip : stroke(*surface, scale, scale * radius, 5e-4 * scale, 150)) {
          const auto exact = synthetic::exact_contact(*surface, tip, wall_stiffness / scale, scale * radius);
          const StepResult result = hand.to(tip);
          if (exact.depth_m > 1e-9 * scale) {
            ASSERT_EQ(result.contact, exact.contact) << name;
          }
          worst = std::max(worst, (result.f_W_N - exact.f_W_N).norm());
        }
        // The gradient is known to 1e-11 (finite differences of fourth order); over 0.5 mm of depth and the ball's
        // radius that is the smallest part of it: the distance itself is known to 16 roundings of 0.1 m.
        EXPECT_LE(worst, wall_stiffness * 1e-11) << name << " scale " << scale << " radius " << radius;
      }
    }
  }
}

TEST(Implicit, IsAReferenceForTheGodObjectOnAFineMesh) {
  for (const char* name : {"bumpy", "torus", "duck"}) {
    const std::shared_ptr<const synthetic::AnalyticSurface> surface = synthetic::make_surface(name);
    const auto mesh = surface->tessellate(20000);
    const auto reference = implicit(surface, wall_stiffness);
    const auto polygonal = god_object(mesh.mesh, wall_stiffness);
    Hand left(*reference);
    Hand right(*polygonal);
    for (const Vec3& tip : stroke(*surface, 1.0, 0.0, 1e-3, 400)) {
      const StepResult a = left.to(tip);
      const StepResult b = right.to(tip);
      ASSERT_NEAR(a.depth_m, b.depth_m, mesh.deviation_bound_m + 1e-9) << name;
    }
  }
}

TEST(Implicit, StaysOutsideThinShellsAndJumpsOnAnalyticSurfaces) {
  for (const double thickness : {2e-3, 2e-4, 5e-5}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const std::shared_ptr<const Surface> shell =
          synthetic::make_surface("thin-shell", {{"thickness_m", thickness * scale}, {"half_side_m", 0.05 * scale}});
      const auto renderer = implicit(shell, wall_stiffness / scale);
      Hand hand(*renderer);
      double last = 0.0;
      for (int i = -5; i <= 300; ++i) {
        const StepResult now = hand.to(scale * Vec3(0.0013, 0.0021, -1e-5 * i));
        ASSERT_GE(now.f_W_N.z(), last);
        ASSERT_NEAR(now.f_W_N.z(), wall_stiffness * 1e-5 * std::max(i, 0), wall_stiffness * 1e-10);
        last = now.f_W_N.z();
      }
      // In one step.
      Hand other(*renderer);
      EXPECT_FALSE(other.to(scale * Vec3(0.0013, 0.0021, 0.01)).contact);
      const StepResult below = other.to(scale * Vec3(0.0013, 0.0021, -0.01));
      EXPECT_TRUE(below.contact) << thickness;
      EXPECT_NEAR(below.depth_m, 0.01 * scale, 1e-9 * scale);
      EXPECT_FALSE(other.to(scale * Vec3(0.0013, 0.0021, 0.001)).contact);
    }
  }
}

TEST(SignedField, TheCubicIsExactForADistanceThatIsLinearAndOfThirdOrderElsewhere) {
  const auto plane = synthetic::make_surface("plane", {{"half_side_m", 0.03}});
  const synthetic::PosedSurface tilted(
      std::shared_ptr<const synthetic::AnalyticSurface>(synthetic::make_surface("plane", {{"half_side_m", 0.03}})),
      awkward_rotation(), Vec3(0.001, 0.002, 0.003));
  const auto field = make_sampled_field(tilted, 24);
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = 0.02 * random.uniform(0, 1) * random.direction();
    ASSERT_NEAR(field->value_m(p), tilted.signed_distance(p), 1e-15);
    ASSERT_LE((field->gradient(p) - tilted.closest(p).n_W).norm(), 1e-12);
  }
  const auto sphere = synthetic::make_surface("sphere", {{"radius_m", 0.03}});
  double last = 0.0;
  for (const int resolution : {24, 41, 75}) {  // steps of 60 mm over 17, 34 and 68
    const auto sampled = make_sampled_field(*sphere, resolution);
    double worst = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 p = random.uniform(0.028, 0.031) * random.direction();
      worst = std::max(worst, std::abs(sampled->value_m(p) - sphere->signed_distance(p)));
      const double d = 1e-7;
      const Vec3 slope = sampled->gradient(p);
      for (Eigen::Index a = 0; a < 3; ++a) {
        const double numeric =
            (sampled->value_m(p + d * Vec3::Unit(a)) - sampled->value_m(p - d * Vec3::Unit(a))) / (2 * d);
        ASSERT_NEAR(slope[a], numeric, 1e-6);
      }
    }
    if (last > 0.0) {
      EXPECT_GT(last / worst, 6.0) << "at least third order: halving the step gains a factor of 8";
    }
    last = worst;
  }
}

TEST(SignedField, IsTheSameToTheBitWhateverTheNumberOfThreads) {
  const auto surface = make_embree_surface(synthetic::make_mesh("duck", {}, 2000).mesh);
  const auto many = make_sampled_field(*surface, 24);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = make_sampled_field(*surface, 24);
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = 0.06 * random.uniform(0, 1) * random.direction();
    ASSERT_EQ(many->value_m(p), single->value_m(p));
  }
}

// The field's samples smooth the mesh: off by the mesh's deviation and the cubic's error.
TEST(Implicit, OnAMeshItFollowsTheSmoothBody) {
  for (const char* name : {"sphere", "bumpy", "duck"}) {
    const std::shared_ptr<const synthetic::AnalyticSurface> surface = synthetic::make_surface(name);
    const auto tessellation = surface->tessellate(5000);
    const auto renderer = implicit(make_embree_surface(tessellation.mesh), wall_stiffness, 0.0, 40.0);
    Hand hand(*renderer);
    double worst = 0.0;
    int touching = 0;
    for (const Vec3& tip : stroke(*surface, 1.0, 0.0, 5e-4, 300)) {
      const auto exact = synthetic::exact_contact(*surface, tip, wall_stiffness, 0.0);
      const StepResult result = hand.to(tip);
      worst = std::max(worst, std::abs(result.depth_m - exact.depth_m));
      touching += result.contact ? 1 : 0;
    }
    EXPECT_GT(touching, 200);
    const double step = surface->bounds().sizes().maxCoeff() / 33.0;
    // The cubic's own error: third order in the step over the radius of curvature, at least six steps in these bodies.
    EXPECT_LE(worst, tessellation.deviation_bound_m + 0.02 * step) << name;
    EXPECT_GT(worst, 1e-3 * step) << name << ": or the bound says nothing";
  }
}

// Turned, so that no node of the grid lies in its faces.
std::shared_ptr<const Surface> turned(const surface::TriangleMesh& mesh) {
  return make_embree_surface(surface::moved(mesh, awkward_rotation(), Vec3::Zero()));
}

TEST(Implicit, PinnedLimitAMeshThinnerThanTwoSamplesIsNotThere) {
  const auto plate = turned(synthetic::make_mesh("thin-shell", {{"thickness_m", 2e-4}}, 200).mesh);
  const auto renderer = implicit(plate, wall_stiffness);
  Hand hand(*renderer);
  StepResult now;
  for (int i = 0; i <= 200; ++i) now = hand.to(awkward_rotation() * Vec3(0.0013, 0.0021, 1e-3 - 1e-5 * i));
  EXPECT_LT(now.f_W_N.norm(), 0.5 * wall_stiffness * 1e-3) << "known limit: 1 mm below its top";
  EXPECT_NE(find_limitation(implicit_entry().cannot, rendering::Ability::thin_shells), nullptr);
}

TEST(Implicit, PinnedLimitTheEdgesOfAMeshAreRounded) {
  const auto surface = turned(testing::cube(0.02));
  const auto renderer = implicit(surface, wall_stiffness, 0.0, 40.0);
  Hand hand(*renderer);
  double off = 0.0;
  for (int i = 0; i < 100; ++i) {
    const StepResult now = hand.to(awkward_rotation() * (Vec3(0.0205, 0.003, 0.0205) - 1e-5 * i * Vec3(1, 0, 1)));
    if (now.contact) off = std::max(off, surface->closest(now.contact_W_m).distance_m);
  }
  EXPECT_GT(off, 1e-5) << "known limit: the contact point is not on the mesh";
  EXPECT_NE(find_limitation(implicit_entry().cannot, rendering::Ability::surface_contact), nullptr);
}

}  // namespace
}  // namespace touchstone::renderers
