#include "harness/surface/mesh_topology.h"

#include <gtest/gtest.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>

#include "harness/base/random.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::surface {
namespace {

using testing::ball;
using testing::cube;
using testing::grid;
using testing::torus;

// An independent twin: OpenMesh's half-edges.
using Twin = OpenMesh::TriMesh_ArrayKernelT<>;
Twin twin_of(const TriangleMesh& mesh) {
  Twin twin;
  for (const Vec3& v : mesh.vertices_W_m)
    twin.add_vertex(Twin::Point(static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())));
  for (const auto& [a, b, c] : mesh.triangles)
    twin.add_face(Twin::VertexHandle(a), Twin::VertexHandle(b), Twin::VertexHandle(c));
  return twin;
}

TEST(MeshTopology, NeighboursAndFansAgreeWithOpenMesh) {
  for (const TriangleMesh& mesh : {cube(1.0), grid(1.0, 7), ball(1.0, 3), torus(1.0, 0.3, 9, 7)}) {
    SCOPED_TRACE(mesh.source);
    const MeshTopology topology = make_topology(mesh);
    const Twin twin = twin_of(mesh);
    ASSERT_EQ(twin.n_faces(), mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t e = 0; e < 3; ++e) {
        const auto h = twin.find_halfedge(Twin::VertexHandle(mesh.triangles[t][e]),
                                          Twin::VertexHandle(mesh.triangles[t][(e + 1) % 3]));
        ASSERT_EQ(topology.neighbours[t][e], h.opp().face().idx());
      }
    }
    for (std::size_t v = 0; v < mesh.vertices_W_m.size(); ++v) {
      const auto fan = topology.fan(v);
      EXPECT_EQ(fan.size(), twin.valence(Twin::VertexHandle(static_cast<int>(v))) -
                                (twin.is_boundary(Twin::VertexHandle(static_cast<int>(v))) ? 1U : 0U));
      EXPECT_EQ((topology.vertex_flags[v] & vertex_open) != 0,
                twin.is_boundary(Twin::VertexHandle(static_cast<int>(v))));
      // Each follows its predecessor counter-clockwise: across the edge that ends in v.
      for (std::size_t i = 1; i < fan.size(); ++i) {
        const auto& corners = mesh.triangles[static_cast<std::size_t>(fan[i - 1])];
        const auto corner = static_cast<std::size_t>(
            std::find(corners.begin(), corners.end(), static_cast<std::int32_t>(v)) - corners.begin());
        EXPECT_EQ(topology.neighbours[static_cast<std::size_t>(fan[i - 1])][(corner + 2) % 3], fan[i]);
      }
    }
  }
}

TEST(MeshTopology, ClosedAndOpen) {
  EXPECT_TRUE(make_topology(cube(1.0)).closed());
  EXPECT_TRUE(make_topology(torus(1.0, 0.3, 9, 7)).closed());
  EXPECT_EQ(make_topology(grid(1.0, 5)).open_edge_count, 20U);
}

TEST(MeshTopology, ConvexityAtEveryScaleAndPose) {
  Random random(2);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const MeshTopology topology =
        make_topology(moved(cube(1.0), random.rotation(), 10.0 * scale * random.direction(), scale));
    int ridges = 0;
    for (const auto& edges : topology.convexity)
      ridges += static_cast<int>(std::count(edges.begin(), edges.end(), Convexity::ridge));
    EXPECT_EQ(ridges, 24);  // 12 edges from both sides; the 6 diagonals are flat
  }
  // A valley: the cube turned inside out.
  TriangleMesh inward = cube(1.0);
  for (auto& t : inward.triangles) std::swap(t[1], t[2]);
  const MeshTopology topology = make_topology(inward);
  for (const auto& edges : topology.convexity) EXPECT_EQ(std::count(edges.begin(), edges.end(), Convexity::valley), 2);
}

TEST(MeshTopology, PseudoNormalsOfACubeAreItsDiagonals) {
  // The angle weights make the normal independent of how the faces are divided into triangles.
  const TriangleMesh mesh = cube(1.0);
  const MeshTopology topology = make_topology(mesh);
  for (std::size_t v = 0; v < mesh.vertices_W_m.size(); ++v) {
    EXPECT_LT((topology.vertex_normals[v] - mesh.vertices_W_m[v].normalized()).norm(), 1e-15);
  }
}

TEST(MeshTopology, NonManifoldAndDisorientedEdgesAreNamed) {
  TriangleMesh mesh = grid(1.0, 1);
  mesh.vertices_W_m.emplace_back(0, 0, 1);
  mesh.triangles.push_back({0, 3, 4});  // a third triangle on the diagonal
  MeshTopology topology = make_topology(mesh);
  ASSERT_EQ(topology.non_manifold_edges.size(), 1U);
  EXPECT_EQ(topology.non_manifold_edges[0], (std::array<std::int32_t, 2>{0, 3}));
  EXPECT_TRUE(topology.vertex_flags[0] & vertex_non_manifold);

  mesh = grid(1.0, 1);
  std::swap(mesh.triangles[1][0], mesh.triangles[1][1]);
  topology = make_topology(mesh);
  EXPECT_EQ(topology.disoriented_edges.size(), 1U);
  EXPECT_FALSE(topology.closed());
}

TEST(MeshTopology, TwoFansAtOneVertex) {
  TriangleMesh mesh;
  mesh.vertices_W_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {1, 1, 2}};
  const MeshTopology topology = make_topology(mesh);
  EXPECT_TRUE(topology.vertex_flags[0] & vertex_non_manifold);
  EXPECT_EQ(topology.fan(0).size(), 2U);
  EXPECT_EQ(topology.neighbours[2][1], open_edge);
  EXPECT_EQ(topology.fan(1).size(), 1U);
}

}  // namespace
}  // namespace touchstone::surface
