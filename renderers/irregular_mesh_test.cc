// Meshes that are not what a mesh should be: the god-object still passes through nothing that it meets, and no answer
// is not finite.
#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "harness/surface/mesh_repair.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "renderers/mesh_traversal/mesh_regularity.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
using rendering::StepResult;
using surface::TriangleMesh;

namespace {

constexpr double stiffness = 500.0;

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  const auto offset = static_cast<std::int32_t>(a.vertices_W_m.size());
  both.vertices_W_m.insert(both.vertices_W_m.end(), b.vertices_W_m.begin(), b.vertices_W_m.end());
  for (const auto& [i, j, k] : b.triangles) both.triangles.push_back({i + offset, j + offset, k + offset});
  return both;
}

std::size_t irregular(const TriangleMesh& mesh) {
  const surface::TriangleTree tree(mesh);
  const auto regular = regular_triangles(mesh, make_topology(mesh), tree);
  return static_cast<std::size_t>(std::count(regular.begin(), regular.end(), false));
}

// Two cubes of 40 mm that overlap: the second 30 mm along x and turned about z.
TriangleMesh crossing_cubes() {
  return joined(testing::cube(0.02), surface::moved(testing::cube(0.02), Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ())),
                                                    {0.03, 0.001, 0.0013}));
}

TEST(MeshRegularity, SoundMeshesAreRegularEverywhere) {
  for (const auto& entry : synthetic::surface_catalogue()) {
    EXPECT_EQ(irregular(synthetic::make_mesh(entry.name, {}, 2000).mesh), 0U) << entry.name;
  }
  EXPECT_EQ(irregular(testing::torus(0.03, 0.01, 30, 20)), 0U);
}

TEST(MeshRegularity, CrossingsFoldsDuplicatesAndExtraTrianglesAreFound) {
  EXPECT_GE(irregular(crossing_cubes()), 4U);
  TriangleMesh duplicate = testing::cube(0.02);
  duplicate.triangles.push_back(duplicate.triangles[0]);
  EXPECT_GE(irregular(duplicate), 2U);
  // A fin on an edge: three triangles at it.
  TriangleMesh fin = testing::grid(0.02, 2);
  fin.vertices_W_m.emplace_back(0.0, 0.0, 0.01);
  fin.triangles.push_back({4, 5, 9});
  EXPECT_GE(irregular(fin), 3U);
  // Two triangles folded flat onto one another.
  TriangleMesh fold;
  fold.vertices_W_m = {{0, 0, 0}, {1, 0, 0}, {0.2, 1, 0}, {0.4, 0.8, 0}};
  fold.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(irregular(fold), 2U);
}

TEST(IrregularMesh, OverCrossingBodiesItStaysOutsideOfBoth) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const TriangleMesh mesh =
        surface::moved(crossing_cubes(), awkward_rotation(), scale * Vec3(0.01, 0.02, -0.03), scale);
    const auto renderer = god_object(mesh, stiffness / scale);
    const auto at = [&](const Vec3& p) {
      return Vec3(awkward_rotation() * (scale * p) + scale * Vec3(0.01, 0.02, -0.03));
    };
    Hand hand(*renderer);
    // Along the top from the first cube's (z = 20 mm) to the second's (z = 21.3 mm), 0.5 mm below the first's.
    hand.to(at({-0.01, 0.002, 0.03}));
    StepResult result;
    for (int i = 0; i <= 400; ++i) {
      result = hand.to(at({-0.01 + i * 1e-4, 0.002, 0.0195}));
      ASSERT_TRUE(result.contact) << "scale " << scale << " step " << i;
      const Vec3 g = awkward_rotation().conjugate() * (result.contact_W_m - scale * Vec3(0.01, 0.02, -0.03)) / scale;
      ASSERT_GE(g.z(), 0.02 - 1e-12) << "scale " << scale << " step " << i;
      ASSERT_TRUE(result.f_W_N.allFinite());
    }
    // It is held by the second cube's side, which rises 1.3 mm above the first's top.
    const Vec3 g = awkward_rotation().conjugate() * (result.contact_W_m - scale * Vec3(0.01, 0.02, -0.03)) / scale;
    EXPECT_LT(g.x(), 0.0125);
    EXPECT_NEAR(g.z(), 0.02, 1e-12);
    EXPECT_GT(result.depth_m / scale, 0.015);
  }
}

// One triangle in a hundred inside out: a one-sided proxy falls through one of them; repaired it feels the sound mesh,
// and two-sided it stays outside of it.
TEST(IrregularMesh, TurnedTrianglesHoldWhenTheyAreRepairedOrTwoSided) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const double major = 0.03 * scale;
    const double minor = 0.012 * scale;
    const TriangleMesh sound = testing::torus(major, minor, 60, 40);
    TriangleMesh broken = sound;
    Random random(9);
    for (auto& triangle : broken.triangles) {
      if (random.uniform() < 0.01) std::swap(triangle[1], triangle[2]);
    }
    const auto expected = god_object(sound, stiffness / scale);
    const auto as_it_is = god_object(broken, stiffness / scale);
    const auto repaired = god_object(orient(broken).mesh, stiffness / scale);
    const auto both = god_object(two_sided(broken), stiffness / scale);
    Hand over_sound(*expected), over_broken(*as_it_is), over_repaired(*repaired), over_both(*both);
    int lost = 0;
    for (int i = 0; i < 10000; ++i) {
      // Round the tube and along it, 1 mm deep; from 3 mm above.
      const double tube = 0.0031 * i, along = 0.00173 * i;
      const double radius = minor + scale * std::max(-1e-3, 3e-3 - 1e-4 * i);
      const Vec3 p((major + radius * std::cos(tube)) * std::cos(along),
                   (major + radius * std::cos(tube)) * std::sin(along), radius * std::sin(tube));
      const StepResult truth = over_sound.to(p);
      lost += truth.contact && !over_broken.to(p).contact ? 1 : 0;
      ASSERT_EQ(over_repaired.to(p).f_W_N, truth.f_W_N) << i;
      const StepResult held = over_both.to(p);
      ASSERT_EQ(held.contact, truth.contact) << "scale " << scale << " step " << i;
      // At an edge it may rest where a walk slides on (plane_contact.h): a facet's bend beside the depth.
      ASSERT_LE((held.f_W_N - truth.f_W_N).norm(), 0.2 * stiffness * 1e-3) << "scale " << scale << " step " << i;
    }
    EXPECT_GT(lost, 0) << "scale " << scale;
  }
}

TEST(IrregularMesh, NoPressThroughAnyOfThemAndNoAnswerThatIsNotFinite) {
  TriangleMesh broken = testing::ball(0.02, 3);
  // Holes, duplicates, triangles without area, turned triangles, a fin.
  broken.triangles.erase(broken.triangles.begin() + 40, broken.triangles.begin() + 60);
  broken.triangles.push_back(broken.triangles[10]);
  broken.triangles.push_back({5, 5, 9});
  broken.triangles.push_back({1, 2, 1});
  std::swap(broken.triangles[100][0], broken.triangles[100][1]);
  broken.vertices_W_m.emplace_back(0.0, 0.0, 0.03);
  broken.triangles.push_back(
      {broken.triangles[20][0], broken.triangles[20][1], static_cast<std::int32_t>(broken.vertices_W_m.size()) - 1});
  TriangleMesh soup;
  Random random(30);
  for (int t = 0; t < 300; ++t) {
    for (int i = 0; i < 3; ++i) soup.vertices_W_m.push_back(0.02 * random.uniform() * random.direction());
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  for (const TriangleMesh& mesh : {broken, soup, crossing_cubes()}) {
    for (const double radius : {0.0, 1e-3}) {
      const auto renderer = god_object(mesh, stiffness, radius);
      Hand hand(*renderer);
      Vec3 p(0.05, 0.04, 0.03);
      Vec3 target = p;
      int touching = 0;
      for (int i = 0; i < 3000; ++i) {
        if (i % 60 == 0) target = 0.05 * random.uniform() * random.direction();
        p += 0.05 * (target - p) + 2e-4 * random.direction();
        const StepResult result = hand.to(p);
        ASSERT_TRUE(result.f_W_N.allFinite() && result.contact_W_m.allFinite() && result.n_W.allFinite()) << i;
        ASSERT_LT(result.depth_m, 0.2);
        touching += result.contact ? 1 : 0;
      }
      EXPECT_GT(touching, 100);
    }
  }
}

// A sheet that stops the tip from either side, also a tip that was in the sheet itself. CHAI3D's dynamic proxy (3.3.0,
// world in millimetres, setHapticTriangleSides(true, true)) stands off by its epsilon of 0.1 um: 0.40008,
// 0.80008, 1.20008 and 1.60008 N at 0.5 to 2 mm, up or down, and nothing sideways.
TEST(IrregularMesh, ASheetOfTwoSidesStopsTheTipAsChai3dDoes) {
  constexpr double stiff = 800.0;
  for (const char* const name : {"god-object", "friction-cone", "force-shading"}) {
    const auto renderer = make_renderer(model_of(name, {{"stiffness_N_per_m", stiff}}),
                                        make_embree_surface(two_sided(touchstone::testing::grid(1.0, 2))));
    // Over a face, along the diagonal of a square, through the middle vertex.
    for (const Vec3& along : {Vec3(0.3, -0.2, 0.0), Vec3(0.3, 0.3, 0.0), Vec3(-0.3, 0.2, 0.0)}) {
      for (const double side : {1.0, -1.0}) {
        Hand hand(*renderer);
        const Vec3 touches = along.x() < 0.0          ? Vec3(0.0, 0.0, 0.0)
                             : along.x() == along.y() ? Vec3(0.01, 0.01, 0.0)
                                                      : Vec3(0.002, 0.001, 0.0);
        for (int i = 0; i <= 8; ++i) {
          const Vec3 tip = touches + 1e-3 * (i - 4) * along + Vec3(0.0, 0.0, side * (2.0 - 0.5 * i) * 1e-3);
          const StepResult result = hand.to(tip);
          if (i == 4) continue;  // in the sheet CHAI3D's epsilon is all there is
          const double chai3d_N = i < 4 ? 0.0 : side * (0.4 * (i - 4) + 0.00008);
          EXPECT_NEAR((result.f_W_N - Vec3(0.0, 0.0, chai3d_N)).norm(), 0.0, stiff * 1.01e-7)
              << name << " " << along.transpose() << " " << side << " " << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::renderers
