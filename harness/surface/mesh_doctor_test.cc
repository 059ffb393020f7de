// Each defect made by hand, alone: found under its name, at its place, and nothing else that matters is claimed.
#include "harness/surface/mesh_doctor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/json_reader.h"
#include "harness/base/random.h"
#include "harness/surface/cgal/exact_surface.h"
#include "harness/surface/cgal/self_intersection.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::surface {
namespace {

using testing::ball;
using ::testing::Contains;
using testing::cube;
using ::testing::ElementsAre;
using testing::grid;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

MeshDiagnosis examine(const TriangleMesh& mesh, const MeshDoctorRule& rule = {}) {
  return examine_mesh(mesh, rule, self_intersections);
}

std::vector<std::string> names(const MeshDiagnosis& diagnosis) {
  std::vector<std::string> out;
  for (const MeshFinding& finding : diagnosis.findings) out.push_back(finding.name);
  return out;
}

const MeshFinding& finding(const MeshDiagnosis& diagnosis, const std::string& name) {
  for (const MeshFinding& found : diagnosis.findings) {
    if (found.name == name) return found;
  }
  throw std::runtime_error(name + " was not found");
}

TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto shift = static_cast<std::int32_t>(a.vertices_W_m.size());
  a.vertices_W_m.insert(a.vertices_W_m.end(), b.vertices_W_m.begin(), b.vertices_W_m.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + shift, j + shift, k + shift});
  return a;
}

TriangleMesh inside_out(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

// One vertex drawn over the next ring, as a collapse of an edge may leave it.
TEST(MeshDoctor, NamesAFoldAndNoRidge) {
  TriangleMesh mesh = ball(1.0, 3);
  const auto [a, b, c] = mesh.triangles[100];
  const auto corner = [&mesh](std::int32_t v) -> Vec3& { return mesh.vertices_W_m[static_cast<std::size_t>(v)]; };
  corner(a) = 2.2 * (0.5 * (corner(b) + corner(c))) - 1.2 * corner(a);
  corner(a) *= 0.98 / corner(a).norm();
  EXPECT_THAT(names(examine(mesh)), Contains("folds"));
  EXPECT_FALSE(examine(mesh).sound());
  // Ridges and tips, sharp ones too.
  for (const Vec3& stretch : {Vec3(1.0, 1.0, 0.02), Vec3(0.05, 0.05, 1.0)}) {
    for (TriangleMesh sharp : {cube(1.0), ball(1.0, 2), testing::torus(1.0, 0.3, 12, 8)}) {
      for (Vec3& v : sharp.vertices_W_m) v = v.cwiseProduct(stretch);
      EXPECT_THAT(names(examine(sharp)), Not(Contains("folds"))) << sharp.source;
    }
  }
}

TEST(MeshDoctor, SoundMeshesAtEveryScale) {
  Random random(1);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const TriangleMesh& mesh : {cube(1.0), ball(1.0, 3), testing::torus(1.0, 0.3, 12, 8)}) {
      const MeshDiagnosis diagnosis = examine(moved(mesh, random.rotation(), 5.0 * scale * random.direction(), scale));
      EXPECT_THAT(names(diagnosis), IsEmpty()) << mesh.source;
      EXPECT_TRUE(diagnosis.sound());
    }
  }
  const MeshDiagnosis diagnosis = examine(cube(1.0));
  EXPECT_DOUBLE_EQ(diagnosis.volume_m3, 8.0);
  EXPECT_DOUBLE_EQ(diagnosis.area_m2, 24.0);
}

TEST(MeshDoctor, OpenEdgesAndLoops) {
  TriangleMesh mesh = ball(1.0, 2);
  mesh.triangles.erase(mesh.triangles.begin() + 100);
  mesh.triangles.erase(mesh.triangles.begin());
  const MeshDiagnosis diagnosis = examine(mesh);
  EXPECT_THAT(names(diagnosis), ElementsAre("open-edges"));
  EXPECT_EQ(diagnosis.open_edges, 6U);
  EXPECT_EQ(diagnosis.boundary_loops, 2U);
  EXPECT_FALSE(diagnosis.sound());
  EXPECT_TRUE(examine(mesh, {.sheet = true}).sound());
  EXPECT_EQ(examine(grid(1.0, 4)).boundary_loops, 1U);
}

TEST(MeshDoctor, FlippedTriangles) {
  TriangleMesh mesh = ball(1.0, 2);
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  const MeshDiagnosis diagnosis = examine(mesh);
  EXPECT_THAT(names(diagnosis), ElementsAre("inconsistent-orientation"));
  EXPECT_EQ(finding(diagnosis, "inconsistent-orientation").count, 1U);
  EXPECT_THAT(finding(diagnosis, "inconsistent-orientation").places[0].triangles, ElementsAre(7));
}

TEST(MeshDoctor, InwardFacingBodyButNotAHollow) {
  const MeshDiagnosis diagnosis = examine(inside_out(ball(1.0, 2)));
  EXPECT_THAT(names(diagnosis), ElementsAre("inward-facing"));
  EXPECT_THAT(names(examine(together(ball(1.0, 2), inside_out(ball(0.5, 2))))), ElementsAre("components"));
  EXPECT_THAT(names(examine(together(ball(1.0, 2), moved(inside_out(ball(0.5, 2)), Quat::Identity(), {3, 0, 0})))),
              ElementsAre("inward-facing", "components"));
}

TEST(MeshDoctor, DegenerateTriangles) {
  TriangleMesh mesh = cube(1.0);
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_THAT(names(examine(mesh)), Contains("degenerate-triangles"));
  EXPECT_THAT(finding(examine(mesh), "degenerate-triangles").places[0].triangles, ElementsAre(12));
  // Nearly on one line, at another scale: relative to the size.
  for (const double scale : {1e-3, 1e3}) {
    TriangleMesh sliver;
    sliver.vertices_W_m = {{0, 0, 0}, {scale, 0, 0}, {0.5 * scale, 1e-10 * scale, 0}};
    sliver.triangles = {{0, 1, 2}};
    EXPECT_THAT(names(examine(sliver)), Contains("degenerate-triangles"));
    sliver.vertices_W_m[2].y() = 1e-6 * scale;
    EXPECT_THAT(names(examine(sliver)), ElementsAre("open-edges"));
  }
}

TEST(MeshDoctor, DuplicateTriangles) {
  TriangleMesh mesh = cube(1.0);
  mesh.triangles.push_back({2, 1, 0});  // the first one again, from behind
  const MeshDiagnosis diagnosis = examine(mesh);
  EXPECT_THAT(finding(diagnosis, "duplicate-triangles").places[0].triangles, ElementsAre(0, 12));
  EXPECT_FALSE(diagnosis.sound());
}

TEST(MeshDoctor, DuplicateAndUnusedVertices) {
  TriangleMesh mesh = cube(1.0);
  mesh.vertices_W_m.push_back(mesh.vertices_W_m[3]);
  mesh.triangles[1][2] = 8;
  mesh.vertices_W_m.emplace_back(9, 9, 9);
  const MeshDiagnosis diagnosis = examine(mesh);
  EXPECT_THAT(names(diagnosis), ElementsAre("duplicate-vertices", "unused-vertices"));
  EXPECT_THAT(finding(diagnosis, "duplicate-vertices").places[0].vertices, ElementsAre(3, 8));
  EXPECT_THAT(finding(diagnosis, "unused-vertices").places[0].vertices, ElementsAre(9));
  EXPECT_TRUE(diagnosis.sound());
  EXPECT_EQ(diagnosis.bounds.max(), Vec3::Ones());
}

TEST(MeshDoctor, NonManifoldEdgesAndVertices) {
  // Two tetrahedra that share an edge, and two that share a vertex.
  TriangleMesh tetrahedron;
  tetrahedron.vertices_W_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  TriangleMesh mirrored = inside_out(tetrahedron);
  for (Vec3& v : mirrored.vertices_W_m) v = Vec3(-v.x(), v.y(), v.z());
  TriangleMesh by_edge = tetrahedron;
  for (const auto& [a, b, c] : mirrored.triangles) {
    // Vertices 0, 2, 3 lie on the mirror: share 0 and 3, double 2.
    const auto name = [](std::int32_t v) { return v == 1 ? 4 : v == 2 ? 5 : v; };
    by_edge.triangles.push_back({name(a), name(b), name(c)});
  }
  by_edge.vertices_W_m.emplace_back(-1, 0, 0);
  by_edge.vertices_W_m.emplace_back(-0.5, 1, 0);
  const MeshDiagnosis edge = examine(by_edge);
  EXPECT_THAT(names(edge), ElementsAre("non-manifold-edges"));
  EXPECT_THAT(finding(edge, "non-manifold-edges").places[0].vertices, ElementsAre(0, 3));
  EXPECT_EQ(finding(edge, "non-manifold-edges").places[0].triangles.size(), 4U);

  TriangleMesh opposite = inside_out(tetrahedron);
  for (Vec3& v : opposite.vertices_W_m) v = -v;
  const MeshDiagnosis vertex = examine(together(tetrahedron, opposite));
  EXPECT_THAT(names(vertex), ElementsAre("duplicate-vertices", "non-manifold-vertices", "components"));
  EXPECT_THAT(finding(vertex, "non-manifold-vertices").places[0].vertices, ElementsAre(0));
  EXPECT_FALSE(vertex.sound());
}

TEST(MeshDoctor, SelfIntersection) {
  const TriangleMesh mesh = together(cube(1.0), moved(cube(1.0), Quat::Identity(), {0.5, 0.6, 0.7}));
  const MeshDiagnosis diagnosis = examine(mesh);
  EXPECT_EQ(diagnosis.self_intersection_checked, exact_surface_available());
  if (!exact_surface_available()) {
    EXPECT_THAT(diagnosis_text(diagnosis, "m.obj"), HasSubstr("Self-intersection was not checked"));
    GTEST_SKIP() << "this build has no CGAL";
  }
  EXPECT_THAT(names(diagnosis), ElementsAre("self-intersections", "components"));
  EXPECT_FALSE(diagnosis.sound());
  // A sheet folded onto itself: the two triangles share an edge and lie on the same side of it.
  TriangleMesh folded;
  folded.vertices_W_m = {{0, 0, 0}, {1, 0, 0}, {0.2, 1, 0}, {0.8, 0.9, 0}};
  folded.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_THAT(names(examine(folded)), Contains("self-intersections"));
  folded.vertices_W_m[3].z() = 1e-12;
  EXPECT_THAT(names(examine(folded)), ::testing::Not(Contains("self-intersections")));
}

TEST(MeshDoctor, SeveralPieces) {
  const MeshDiagnosis diagnosis = examine(together(ball(1.0, 1), moved(ball(1.0, 1), Quat::Identity(), {5, 0, 0})));
  EXPECT_THAT(names(diagnosis), ElementsAre("components"));
  EXPECT_EQ(diagnosis.components, 2U);
  EXPECT_TRUE(diagnosis.sound());
}

TEST(MeshDoctor, AMoebiusStripHasNoOrientation) {
  TriangleMesh strip;
  for (int i = 0; i < 5; ++i) {
    const double u = 2.0 * 3.14159265 * i / 5;
    for (const double w : {-0.3, 0.3})
      strip.vertices_W_m.emplace_back((1 + w * std::cos(u / 2)) * std::cos(u), (1 + w * std::cos(u / 2)) * std::sin(u),
                                      w * std::sin(u / 2));
  }
  for (std::int32_t i = 0; i < 5; ++i) {
    const std::int32_t a = 2 * i, b = 2 * i + 1;
    const std::int32_t c = i == 4 ? 1 : 2 * i + 2, d = i == 4 ? 0 : 2 * i + 3;
    strip.triangles.push_back({a, c, b});
    strip.triangles.push_back({b, c, d});
  }
  EXPECT_THAT(finding(examine(strip), "inconsistent-orientation").what,
              HasSubstr("no turning of triangles would make them agree"));
}

TEST(MeshDoctor, JsonSaysTheSame) {
  TriangleMesh mesh = ball(1.0, 2);
  mesh.triangles.pop_back();
  const MeshDiagnosis diagnosis = examine(mesh, {.sheet = false, .largest_listed = 2});
  const auto json = parse_json(diagnosis_json(diagnosis, "b.obj"), "json");
  EXPECT_EQ(json.at("schema"), "touchstone-mesh-diagnosis/1");
  EXPECT_EQ(json.at("sound"), false);
  EXPECT_EQ(json.at("findings").at(0).at("name"), "open-edges");
  EXPECT_EQ(json.at("findings").at(0).at("count"), 3);
  EXPECT_EQ(json.at("findings").at(0).at("places").size(), 2U);
  EXPECT_THAT(diagnosis_text(diagnosis, "b.obj"), HasSubstr("and 1 more"));
}

}  // namespace
}  // namespace touchstone::surface
