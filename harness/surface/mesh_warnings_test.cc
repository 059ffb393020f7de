// Faults made by hand: each is said, with its place; sound meshes and whole sheets are silent.
#include "harness/surface/mesh_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_repair.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::surface {
namespace {

using ::testing::AllOf;
using testing::ball;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> warnings(TriangleMesh mesh) {
  mesh.source = "object.obj";
  return mesh_warnings(*make_embree_surface(mesh));
}

TEST(MeshWarnings, SoundMeshesAndSheetsAreSilent) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const TriangleMesh& mesh :
         {testing::cube(0.02), ball(0.02, 3), testing::torus(0.03, 0.01, 30, 20), testing::grid(0.02, 12)})
      EXPECT_THAT(warnings(moved(mesh, Quat::Identity(), Vec3::Zero(), scale)), IsEmpty());
  }
}

TEST(MeshWarnings, TurnedTrianglesAreSaidWithTheirPlaceAndTheRemedy) {
  TriangleMesh mesh = ball(1.0, 3);
  for (std::size_t t = 7; t < mesh.triangle_count(); t += 100) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  const auto& c = mesh.triangles[7];
  const Vec3 middle =
      (mesh.vertices_W_m[static_cast<std::size_t>(c[0])] + mesh.vertices_W_m[static_cast<std::size_t>(c[1])] +
       mesh.vertices_W_m[static_cast<std::size_t>(c[2])]) /
      3.0;
  char place[100];
  std::snprintf(place, sizeof place, "(%.6g, %.6g, %.6g) m, triangle 7", middle.x(), middle.y(), middle.z());
  EXPECT_THAT(warnings(mesh), ElementsAre(AllOf(HasSubstr("object.obj: inconsistent-orientation: 6 triangles"),
                                                HasSubstr(place), HasSubstr("--repair"))));
  EXPECT_THAT(warnings(orient(mesh).mesh), IsEmpty());
}

TEST(MeshWarnings, OtherFaults) {
  TriangleMesh inside_out = ball(1.0, 2);
  for (auto& triangle : inside_out.triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_THAT(warnings(inside_out), ElementsAre(HasSubstr("inward-facing")));
  TriangleMesh hole = ball(1.0, 3);
  hole.triangles.erase(hole.triangles.begin() + 40);
  EXPECT_THAT(warnings(hole), ElementsAre(HasSubstr("open-edges")));
  TriangleMesh doubled = ball(1.0, 2);
  doubled.triangles.push_back(doubled.triangles[9]);
  EXPECT_THAT(warnings(doubled), Contains(AllOf(HasSubstr("duplicate-triangles"), HasSubstr("triangle 9"))));
  TriangleMesh flat = ball(1.0, 2);
  flat.triangles.push_back({1, 1, 2});
  EXPECT_THAT(warnings(flat), Contains(HasSubstr("degenerate-triangles")));
}

}  // namespace
}  // namespace touchstone::surface
