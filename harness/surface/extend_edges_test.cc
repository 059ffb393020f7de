#include "harness/surface/extend_edges.h"

#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::surface {
namespace {

// Cells of a grid of unit squares at z = 0, outward +z; `cell(x, y)` says which are there.
TriangleMesh grid(int size, double scale, const std::function<bool(int, int)>& cell) {
  TriangleMesh mesh;
  std::map<std::pair<int, int>, std::int32_t> places;
  const auto vertex = [&](int x, int y) {
    const auto [place, made] = places.try_emplace({x, y}, static_cast<std::int32_t>(mesh.vertices_W_m.size()));
    if (made) mesh.vertices_W_m.emplace_back(scale * Vec3(x, y, 0));
    return place->second;
  };
  for (int x = 0; x < size; ++x) {
    for (int y = 0; y < size; ++y) {
      if (!cell(x, y)) continue;
      mesh.triangles.push_back({vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1)});
      mesh.triangles.push_back({vertex(x, y), vertex(x + 1, y + 1), vertex(x, y + 1)});
    }
  }
  return mesh;
}

// How many triangles cover the point (x, y), all of which must look up.
int cover(const TriangleMesh& mesh, double x, double y) {
  int count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](std::size_t i) -> const Vec3& {
      return mesh.vertices_W_m[static_cast<std::size_t>(mesh.triangles[t][i])];
    };
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 edge = corner((i + 1) % 3) - corner(i);
      inside = inside && edge.x() * (y - corner(i).y()) - edge.y() * (x - corner(i).x()) > 0.0;
    }
    count += inside;
  }
  return count;
}

bool round_patch(int x, int y) { return std::hypot(x - 9.5, y - 9.5) < 9.0; }

TEST(ExtendEdges, ARaggedPatchIsCoveredOnceUpToTheNewEdge) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const TriangleMesh mesh = grid(20, scale, round_patch);
    const TriangleMesh wide = extend_open_edges(mesh, 5.0 * scale);
    for (std::size_t t = 0; t < wide.triangles.size(); ++t) EXPECT_GT(wide.scaled_normal(t).z(), 0.0) << t;
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
      const double r = 13.0 * std::sqrt(random.uniform());
      const double a = 2.0 * M_PI * random.uniform();
      EXPECT_EQ(cover(wide, scale * (10.0 + r * std::cos(a)), scale * (10.0 + r * std::sin(a))), 1) << r << ' ' << a;
    }
    // The mesh itself is untouched.
    for (std::size_t i = 0; i < mesh.vertices_W_m.size(); ++i) EXPECT_EQ(wide.vertices_W_m[i], mesh.vertices_W_m[i]);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) EXPECT_EQ(wide.triangles[i], mesh.triangles[i]);
  }
}

TEST(ExtendEdges, HolesAreClosed) {
  const TriangleMesh mesh = grid(20, 1.0, [](int x, int y) { return std::hypot(x - 9.5, y - 9.5) > 4.0; });
  const TriangleMesh wide = extend_open_edges(mesh, 10.0);
  Random random(4);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(cover(wide, random.uniform(-0.5, 20.5), random.uniform(-0.5, 20.5)), 1);
}

TEST(ExtendEdges, ContinuesASlopeAlongItself) {
  TriangleMesh mesh = grid(4, 1.0, [](int, int) { return true; });
  for (Vec3& v : mesh.vertices_W_m) v.z() = 0.5 * v.x();
  for (const Vec3& v : extend_open_edges(mesh, 3.0).vertices_W_m) EXPECT_NEAR(v.z(), 0.5 * v.x(), 1e-12);
}

TEST(ExtendEdges, AClosedMeshStaysAndNonsenseIsRefused) {
  TriangleMesh mesh;
  mesh.vertices_W_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(extend_open_edges(mesh, 1.0).triangles, mesh.triangles);
  EXPECT_THROW(extend_open_edges(mesh, 0.0), UsageError);
  EXPECT_THROW(extend_open_edges(mesh, std::nan("")), UsageError);
  mesh.triangles[3] = {0, 2, 3};
  EXPECT_THROW(extend_open_edges(mesh, 1.0), BadData);
}

TEST(ExtendEdges, TellsWhichTipsTouchWhereTheMeshHasEnded) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const TriangleMesh mesh = grid(4, scale, [](int, int) { return true; });
    const auto surface = make_embree_surface(mesh);
    const MeshTopology topology = make_topology(mesh);
    const std::vector<Vec3> within{scale * Vec3(1.3, 2.7, -0.2), scale * Vec3(2, 2, 0.1), scale * Vec3(1.5, 1.5, 0)};
    EXPECT_EQ(share_at_open_edges(*surface, topology, within), 0.0);
    const std::vector<Vec3> mixed{scale * Vec3(4.5, 2.7, -0.2), scale * Vec3(-1, -1, 0.1), scale * Vec3(1.5, -0.1, 0),
                                  scale * Vec3(1.5, 1.4, 0)};
    EXPECT_EQ(share_at_open_edges(*surface, topology, mixed), 0.75);
    EXPECT_EQ(share_at_open_edges(*surface, topology, {}), 0.0);
  }
}

}  // namespace
}  // namespace touchstone::surface
