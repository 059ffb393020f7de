// Load where the model has no object: beyond the edge of an open mesh, or with the tip outside of it. A recording that
// stays on the object, or rolls off its edge for a moment, is not blamed.
#include "harness/recording_checks/placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/recording/recording_file.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "harness/testing/shared_data.h"

namespace touchstone::recording_checks {
using recording::Recording;

namespace {

using ::testing::HasSubstr;

constexpr double touching_N = 0.05;

// 20 cm wide at z = 0, of 32 triangles, so that the edge has corners within.
std::shared_ptr<const surface::Surface> plate(double unit) {
  surface::TriangleMesh mesh;
  constexpr int cells = 4;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      mesh.vertices_W_m.push_back(unit * Vec3(0.2 * i / cells - 0.1, 0.2 * j / cells - 0.1, 0.0));
    }
  }
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      const int a = i * (cells + 1) + j, b = a + cells + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  mesh.source = "plate";
  return make_embree_surface(mesh);
}

// A circle of 5 cm pressed to 1 mm, its centre moved.
Recording circle(double unit, const Vec3& centre) {
  Recording r;
  for (int i = 0; i < 1000; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 1000.0;
    r.motion.t_s.push_back(0.01 * i);
    r.motion.p_W_m.push_back(unit * (centre + Vec3(0.05 * std::cos(angle), 0.05 * std::sin(angle), -1e-3)));
    r.f_W_N.emplace_back(0.0, 0.0, 1.0);
  }
  return r;
}

TEST(Placement, LoadBeyondTheEdgeOfAnOpenMeshIsNamedAtEveryScale) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    const auto surface = plate(unit);
    RecordingContext context;
    context.surface = surface.get();
    EXPECT_FALSE(find_misplacement(circle(unit, Vec3::Zero()), context, touching_N)) << unit;
    // A sliver of the circle is beyond: a stroke that runs off the edge.
    EXPECT_FALSE(find_misplacement(circle(unit, Vec3(0.056, 0, 0)), context, touching_N)) << unit;
    for (const Vec3& aside : {Vec3(0.08, 0, 0), Vec3(0, -0.08, 0), Vec3(0.09, 0.09, 0)}) {
      const auto found = find_misplacement(circle(unit, aside), context, touching_N);
      ASSERT_TRUE(found) << unit;
      EXPECT_EQ(found->fault, RecordingFault::registration);
      EXPECT_THAT(found->message, HasSubstr("beyond the edge of the mesh"));
    }
  }
}

TEST(Placement, LoadInAirIsNamedAndASmallBiasIsNot) {
  const auto surface = plate(1.0);
  RecordingContext context;
  context.surface = surface.get();
  Recording lifted = circle(1.0, Vec3::Zero());
  for (std::size_t i = 0; i < 300; ++i) lifted.motion.p_W_m[i].z() = 0.02;
  const auto found = find_misplacement(lifted, context, touching_N);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->message, HasSubstr("30 % of the load is measured with the tip outside"));
  for (std::size_t i = 0; i < 700; ++i) lifted.motion.p_W_m[i].z() = 0.02, lifted.f_W_N[i].z() = 0.2;
  EXPECT_FALSE(find_misplacement(lifted, context, touching_N));
}

TEST(Placement, AMissingTipRadiusIsNamedWithItsSize) {
  const auto surface = plate(1.0);
  RecordingContext context;
  context.surface = surface.get();
  const Recording ball = circle(1.0, Vec3(0, 0, 6e-3));
  const auto found = find_misplacement(ball, context, touching_N);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->repair, HasSubstr("--tip-radius 5mm"));
  context.tip_radius_m = 5e-3;
  EXPECT_FALSE(find_misplacement(ball, context, touching_N));
}

// The same robot over another part of the phantom: 47 % of its samples lie beyond the surface of the first.
TEST(Placement, ARealRunOverAnotherAreaIsNamed) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(elsewhere, "palpation/ContPalpTrial1.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(here, "palpation/ContPalpRAL18T2.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(mesh, "palpation/DERIVED_surface_ContPalpRAL18T1.obj");
  const auto surface = make_embree_surface(surface::load_mesh(mesh, 1e-3));
  RecordingContext context;
  context.surface = surface.get();
  EXPECT_FALSE(find_misplacement(recording::load_recording(here), context, touching_N));
  const auto found = find_misplacement(recording::load_recording(elsewhere), context, touching_N);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->message, HasSubstr("beyond the edge of the mesh"));
  EXPECT_THAT(found->message, HasSubstr("outside of the object"));
}

}  // namespace
}  // namespace touchstone::recording_checks
