#include "harness/surface/mesh_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/surface/mesh_topology.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::surface {
namespace {

using testing::ball;
using ::testing::HasSubstr;

TriangleMesh with_turned(TriangleMesh mesh, double share, std::uint64_t seed) {
  Random random(seed);
  for (auto& triangle : mesh.triangles) {
    if (random.uniform() < share) std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

// Up to which corner comes first.
std::vector<std::array<std::int32_t, 3>> turned_alike(const TriangleMesh& mesh) {
  auto triangles = mesh.triangles;
  for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return triangles;
}

TEST(MeshRepair, TurnsWhatFacesTheOtherWayAndNothingElse) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const TriangleMesh& sound : {ball(0.02, 3), testing::torus(0.03, 0.01, 30, 20), testing::cube(0.02)}) {
      const TriangleMesh mesh = moved(sound, Quat(0.8, 0.3, -0.4, 0.2).normalized(), Vec3(1, 2, 3) * scale, scale);
      for (const double share : {0.01, 0.3}) {
        const TriangleMesh broken = with_turned(mesh, share, 3);
        const OrientedMesh repaired = orient(broken);
        EXPECT_EQ(turned_alike(repaired.mesh), turned_alike(mesh));
        std::size_t different = 0;
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
          different += broken.triangles[t] != mesh.triangles[t] ? 1U : 0U;
        EXPECT_EQ(repaired.turned, different);
        EXPECT_EQ(repaired.mesh.vertices_W_m, mesh.vertices_W_m);
      }
      EXPECT_EQ(orient(mesh).turned, 0U);
    }
  }
}

// Each triangle of `mesh` above z = `height` has corners of its own, off by up to `gap`: the seam of a CAD file.
TriangleMesh with_seam(TriangleMesh mesh, double height, double gap) {
  Random random(7);
  std::vector<std::int32_t> own(mesh.vertices_W_m.size(), -1);
  for (auto& triangle : mesh.triangles) {
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t corner : triangle) middle += mesh.vertices_W_m[static_cast<std::size_t>(corner)] / 3;
    if (middle.z() < height) continue;
    for (std::int32_t& corner : triangle) {
      std::int32_t& upper = own[static_cast<std::size_t>(corner)];
      if (upper < 0) {
        upper = static_cast<std::int32_t>(mesh.vertices_W_m.size());
        mesh.vertices_W_m.emplace_back(mesh.vertices_W_m[static_cast<std::size_t>(corner)] + gap * random.direction());
      }
      corner = upper;
    }
  }
  return mesh;
}

TEST(MeshRepair, JoinsSeamsAndNoHoles) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const double gap : {1e-8, 1e-6, 2e-5}) {
      const TriangleMesh sound = moved(ball(0.02, 3), Quat::Identity(), Vec3(1, 2, 3) * scale, scale);
      const TriangleMesh torn = with_seam(sound, 3.005 * scale, gap * scale);
      ASSERT_FALSE(make_topology(torn).closed());
      const OrientedMesh repaired = orient(torn);
      EXPECT_TRUE(make_topology(repaired.mesh).closed()) << scale << " " << gap;
      EXPECT_EQ(repaired.open_edges, 0U);
      EXPECT_EQ(repaired.joined, make_topology(torn).open_edge_count / 2);
      EXPECT_NEAR(repaired.widest_gap_m, gap * scale, 1e-6 * gap * scale + 1e-12 * scale);
      EXPECT_THAT(repair_note(repaired), HasSubstr("0 open edges are left"));
    }
  }
  // Wider than a thousandth of the size it may be meant, and so may a hole be.
  const OrientedMesh wide = orient(with_seam(ball(0.02, 3), 0.005, 2e-4));
  EXPECT_EQ(wide.joined, 0U);
  TriangleMesh hole = with_seam(ball(0.02, 3), 0.005, 1e-6);
  hole.triangles.erase(hole.triangles.begin());
  EXPECT_EQ(orient(hole).open_edges, 3U);
  const OrientedMesh sheet = orient(testing::grid(0.02, 5));
  EXPECT_EQ(sheet.joined, 0U);
  EXPECT_EQ(sheet.open_edges, 20U);
  EXPECT_EQ(repair_note(sheet), "");
}

TEST(MeshRepair, TurnsWholeBodiesButNoHollow) {
  TriangleMesh inside_out = with_turned(ball(0.02, 2), 2.0, 1);
  const OrientedMesh repaired = orient(inside_out);
  EXPECT_EQ(repaired.turned, inside_out.triangle_count());
  EXPECT_EQ(repaired.pieces_turned, 1U);
  EXPECT_EQ(turned_alike(repaired.mesh), turned_alike(ball(0.02, 2)));

  TriangleMesh hollow = ball(0.02, 2);
  const TriangleMesh inner = with_turned(ball(0.01, 2), 2.0, 1);
  const auto offset = static_cast<std::int32_t>(hollow.vertices_W_m.size());
  hollow.vertices_W_m.insert(hollow.vertices_W_m.end(), inner.vertices_W_m.begin(), inner.vertices_W_m.end());
  for (const auto& [a, b, c] : inner.triangles) hollow.triangles.push_back({a + offset, b + offset, c + offset});
  EXPECT_EQ(orient(hollow).turned, 0U);
  // Most of the outer one and all of the inner one the wrong way round.
  EXPECT_EQ(turned_alike(orient(with_turned(hollow, 0.1, 7)).mesh), turned_alike(hollow));
}

TEST(MeshRepair, AFileThatRepeatsItsVerticesKeepsThem) {
  const TriangleMesh sound = ball(0.02, 2);
  TriangleMesh soup;
  for (const auto& triangle : sound.triangles) {
    for (const std::int32_t corner : triangle)
      soup.vertices_W_m.push_back(sound.vertices_W_m[static_cast<std::size_t>(corner)]);
    const auto last = static_cast<std::int32_t>(soup.vertices_W_m.size());
    soup.triangles.push_back({last - 3, last - 2, last - 1});
  }
  std::swap(soup.triangles[5][1], soup.triangles[5][2]);
  const OrientedMesh repaired = orient(soup);
  EXPECT_EQ(repaired.turned, 1U);
  EXPECT_EQ(repaired.mesh.vertices_W_m.size(), soup.vertices_W_m.size());
  EXPECT_EQ(repaired.mesh.scaled_normal(5), -soup.scaled_normal(5));
}

TEST(MeshRepair, AMoebiusStripIsRefusedWithItsPlace) {
  TriangleMesh strip;
  strip.source = "strip";
  for (int i = 0; i < 5; ++i) {
    const double u = 2.0 * std::numbers::pi * i / 5;
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
  try {
    orient(strip);
    FAIL() << "it has no orientation";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("strip: the piece with triangle 0, at (0.7, 0, -0) m, has no orientation"));
  }
}

TEST(MeshRepair, TwoSidedHasEveryTriangleFromBothSides) {
  const TriangleMesh sheet = testing::grid(0.02, 3);
  const TriangleMesh both = two_sided(sheet);
  ASSERT_EQ(both.triangle_count(), 2 * sheet.triangle_count());
  for (std::size_t t = 0; t < sheet.triangle_count(); ++t) {
    EXPECT_EQ(both.scaled_normal(t), sheet.scaled_normal(t));
    EXPECT_EQ(both.scaled_normal(t + sheet.triangle_count()), -sheet.scaled_normal(t));
  }
  // Nothing of it is open.
  EXPECT_EQ(make_topology(both).open_edge_count, 0U);
}

// Brick after brick, each row shifted by a part of a brick and all corners off by up to `off`: every seam is full of
// T-junctions, and no two sheets share a corner.
TriangleMesh bricks(int rows, double length, double off) {
  Random random(11);
  TriangleMesh mesh;
  mesh.source = "bricks.obj";
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < rows; ++k) {
      const auto first = static_cast<std::int32_t>(mesh.vertices_W_m.size());
      const Vec3 corner((k + 0.37 * (row % 3)) * length, 0.5 * row * length, 0.0);
      for (const Vec3& to :
           {Vec3(0, 0, 0), Vec3(length, 0, 0), Vec3(length, 0.5 * length, 0), Vec3(0, 0.5 * length, 0)})
        mesh.vertices_W_m.push_back(
            corner + to + off * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)) / 2);
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  }
  return mesh;
}

// Every edge that does not lie on the outline has two triangles, and the area is the bricks'.
TEST(MeshRepair, WeldingClosesSeamsWithSteps) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const double length = 0.013 * scale;
    constexpr int row_count = 7;
    const TriangleMesh open = bricks(row_count, length, 1e-5 * length);
    const OrientedMesh welded = weld_seams(open, 4e-5 * length);
    EXPECT_GT(welded.joined, 30U);
    EXPECT_GT(welded.split, 30U);
    EXPECT_GT(welded.widest_gap_m, 0.0);
    EXPECT_LE(welded.widest_gap_m, 4e-5 * length);
    const MeshTopology topology = make_topology(welded.mesh);
    EXPECT_EQ(topology.open_edge_count, welded.open_edges);
    EXPECT_TRUE(topology.non_manifold_edges.empty());
    double area = 0.0;
    for (const auto& [a, b, c] : welded.mesh.triangles) {
      const auto p = [&](std::int32_t v) { return welded.mesh.vertices_W_m[static_cast<std::size_t>(v)]; };
      const Vec3 n = (p(b) - p(a)).cross(p(c) - p(a));
      EXPECT_GT(n.z(), 0.0);
      area += 0.5 * n.norm();
    }
    EXPECT_NEAR(area, 0.5 * row_count * row_count * length * length, 1e-3 * length * length);
    for (std::size_t t = 0; t < welded.mesh.triangle_count(); ++t) {
      for (std::size_t e = 0; e < 3; ++e) {
        if (topology.neighbours[t][e] >= 0) continue;
        const Vec3 middle =
            0.5 * (welded.mesh.vertices_W_m[static_cast<std::size_t>(welded.mesh.triangles[t][e])] +
                   welded.mesh.vertices_W_m[static_cast<std::size_t>(welded.mesh.triangles[t][(e + 1) % 3])]);
        const double row = middle.y() / (0.5 * length);
        const double inside = std::min({row, row_count - row});
        const bool at_an_end = middle.x() < 1.3 * length || middle.x() > (row_count - 0.3) * length;
        EXPECT_TRUE(inside < 1e-3 || at_an_end) << middle.transpose();
      }
    }
  }
}

TEST(MeshRepair, WeldingSaysWhatItCannotDo) {
  const TriangleMesh open = bricks(2, 0.01, 1e-6);
  EXPECT_THAT([&] { (void)weld_seams(open, 0.03); }, ::testing::ThrowsMessage<BadData>(::testing::AllOf(
                                                         HasSubstr("bricks.obj: triangle"), HasSubstr("give less"))));
  EXPECT_THROW((void)weld_seams(open, 0.0), UsageError);
  const TriangleMesh closed = ball(0.02, 2);
  const OrientedMesh same = weld_seams(closed, 1e-5);
  EXPECT_EQ(same.mesh.triangles, closed.triangles);
  EXPECT_EQ(same.joined + same.split + same.open_edges, 0U);
}

}  // namespace
}  // namespace touchstone::surface
