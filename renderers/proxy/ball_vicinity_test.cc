// The lists against all triangles of the mesh: none that a ball can meet is missing, and on smooth bodies they are
// short however fine the mesh is.
#include "renderers/proxy/ball_vicinity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "renderers/proxy/ball_constraints.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
namespace {

bool has(std::span<const std::int32_t> list, std::int32_t triangle) {
  return std::find(list.begin(), list.end(), triangle) != list.end();
}

TEST(BallVicinity, MissesNothingThatABallOnATriangleCanMeet) {
  std::size_t listed = 0;
  std::size_t met = 0;
  for (const char* name : {"bumpy", "torus", "v-groove", "duck", "gap", "bowl", "extrusion", "plane"}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const auto surface = make_embree_surface(surface::moved(
          synthetic::make_mesh(name, {}, 1500).mesh, awkward_rotation(), scale * Vec3(0.01, -0.02, 0.005), scale));
      const ContactMesh mesh(*surface);
      const double rounding = 32.0 * std::numeric_limits<double>::epsilon() * mesh.magnitude();
      const auto count = static_cast<std::int32_t>(mesh.triangle_count());
      for (const double radius : {2e-4 * scale, 1e-3 * scale, 5e-3 * scale}) {
        BallVicinity vicinity(mesh, radius);
        Random random(17);
        for (int i = 0; i < 60; ++i) {
          const auto on = static_cast<std::int32_t>(random.uniform(0.0, static_cast<double>(count)));
          const BallVicinity::Of of = vicinity.of(on);
          if (of.spread_m < 0.0) continue;
          ++listed;
          // On the face, and up to the spread beside it; often over an edge or a corner.
          Vec3 share(random.uniform(), random.uniform(), random.uniform());
          for (int k = 0; k < i % 3; ++k) share[(i + k) % 3] = 0.0;
          share /= share.sum();
          const auto corners = mesh.corners(on);
          const Vec3 center =
              share[0] * corners[0] + share[1] * corners[1] + share[2] * corners[2] + radius * mesh.facet(on).n;
          const Vec3 beside = center + 0.999 * of.spread_m * random.direction();
          for (std::int32_t t = 0; t < count; ++t) {
            if (t == on || mesh.facet(t).n.isZero()) continue;
            const bool by_face = has(of.on_face, t);
            const bool any = by_face || has(of.beside, t);
            const bool meets = touch(mesh, t, center).d < radius - rounding;
            met += meets ? 1U : 0U;
            ASSERT_TRUE(by_face || !meets)
                << name << " x " << scale << " radius " << radius << ": " << on << " and " << t;
            ASSERT_TRUE(any || !(touch(mesh, t, beside).d < radius - rounding))
                << name << " x " << scale << " radius " << radius << ": beside " << on << " and " << t;
          }
        }
      }
    }
  }
  EXPECT_GT(listed, 2000U);
  EXPECT_GT(met, 80U);
}

// More triangles than are kept: the oldest is forgotten, and listed alike again.
TEST(BallVicinity, ForgetsTheOldestAndListsItAlikeAgain) {
  const auto surface = make_embree_surface(synthetic::make_mesh("bumpy", {}, 40000).mesh);
  const ContactMesh mesh(*surface);
  BallVicinity vicinity(mesh, 1e-3);
  EXPECT_LT(vicinity.memory_bytes(), 2000000U);
  const auto lists = [&](std::size_t t) {
    const BallVicinity::Of of = vicinity.of(static_cast<std::int32_t>(t));
    return std::tuple(of.spread_m, std::vector(of.on_face.begin(), of.on_face.end()),
                      std::vector(of.beside.begin(), of.beside.end()));
  };
  std::vector<decltype(lists(0))> first;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) first.push_back(lists(t));
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    ASSERT_EQ(lists(t), first[t]) << t;
    if (t > 0) {
      ASSERT_EQ(lists(t - 1), first[t - 1]) << t;
    }
  }
}

TEST(BallVicinity, ListsAreShortHoweverFineTheMeshIs) {
  for (const std::size_t triangles : {2000U, 20000U, 100000U}) {
    const auto surface = make_embree_surface(synthetic::make_mesh("bumpy", {}, triangles).mesh);
    const ContactMesh mesh(*surface);
    BallVicinity vicinity(mesh, 1e-3);
    std::size_t on_face = 0;
    std::size_t all = 0;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
      const BallVicinity::Of of = vicinity.of(static_cast<std::int32_t>(t));
      ASSERT_GE(of.spread_m, 0.0) << triangles << ": " << t;
      on_face += of.on_face.size();
      all += of.on_face.size() + of.beside.size();
    }
    // Twelve triangles or so share a corner with one.
    const auto count = static_cast<double>(mesh.triangle_count());
    EXPECT_LT(static_cast<double>(on_face) / count, 6.0) << triangles;
    EXPECT_LT(static_cast<double>(all) / count, 16.0) << triangles;
  }
}

}  // namespace
}  // namespace touchstone::renderers
