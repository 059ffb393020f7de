// Embree against every triangle in turn, and against the shapes that the meshes stand for.
#include "harness/surface/embree_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/surface/mesh_topology.h"
#include "harness/surface/triangle_queries.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::surface {
namespace {

using testing::ball;
using testing::cube;
using testing::grid;
using testing::torus;

std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t t) {
  std::array<Vec3, 3> out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = mesh.vertices_W_m[static_cast<std::size_t>(mesh.triangles[t][i])];
  return out;
}

double every_triangle_distance(const TriangleMesh& mesh, const MeshTopology& topology, const Vec3& q) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    best = std::min(best, closest_on_triangle(corners(mesh, t), topology.face_normals[t], q).squared_distance);
  }
  return std::sqrt(best);
}

std::optional<double> every_triangle_crossing(const TriangleMesh& mesh, const MeshTopology& topology, const Vec3& a,
                                              const Vec3& b) {
  std::optional<double> best;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto crossing = cross_triangle(corners(mesh, t), topology.face_normals[t], a, b);
    if (crossing && (!best || crossing->fraction < *best)) best = crossing->fraction;
  }
  return best;
}

// The hierarchy must leave out no triangle: the answers are the same numbers, not just close ones.
TEST(EmbreeSurface, SameAsVisitingEveryTriangle) {
  const std::uint64_t seed = 11;
  SCOPED_TRACE(seed);
  Random random(seed);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const double offset : {0.0, 10.0, 1e4}) {
      const TriangleMesh mesh =
          moved(torus(1.0, 0.4, 24, 16), random.rotation(), offset * scale * random.direction(), scale);
      const auto surface = make_embree_surface(mesh);
      const MeshTopology topology = make_topology(mesh);
      const Vec3 center = mesh.bounds().center();
      for (int i = 0; i < 300; ++i) {
        const Vec3 q = center + scale * random.log_uniform(1e-6, 1e3) * random.direction();
        ASSERT_EQ(surface->closest(q).distance_m, every_triangle_distance(mesh, topology, q)) << q.transpose();
        const Vec3 end = i % 2 == 0 ? Vec3(center + scale * random.log_uniform(1e-3, 1e3) * random.direction())
                                    : Vec3(q + scale * random.log_uniform(1e-12, 1.0) * random.direction());
        const auto crossing = surface->first_crossing(q, end);
        const auto expected = every_triangle_crossing(mesh, topology, q, end);
        ASSERT_EQ(crossing.has_value(), expected.has_value()) << q.transpose() << " to " << end.transpose();
        ASSERT_EQ(crossing ? crossing->fraction : -1.0, expected.value_or(-1.0));
      }
    }
  }
}

// Above some number of triangles the hierarchy is made in another way. Beside small triangles a few that are a thousand
// times as large, which that way likes least.
TEST(EmbreeSurface, SameAsVisitingEveryTriangleOfAQuarterOfAMillion) {
  TriangleMesh mesh = torus(1.0, 0.4, 512, 256);
  const TriangleMesh sheet = moved(grid(4.0, 4), Quat::Identity(), {0.0, 0.0, -0.3});
  const auto first = static_cast<std::int32_t>(mesh.vertices_W_m.size());
  mesh.vertices_W_m.insert(mesh.vertices_W_m.end(), sheet.vertices_W_m.begin(), sheet.vertices_W_m.end());
  for (const auto& [a, b, c] : sheet.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  ASSERT_GE(mesh.triangle_count(), 250'000U);
  const auto surface = make_embree_surface(mesh);
  const MeshTopology topology = make_topology(mesh);
  Random random(12);
  for (int i = 0; i < 12; ++i) {
    const Vec3 q = random.log_uniform(0.5, 3.0) * random.direction();
    ASSERT_EQ(surface->closest(q).distance_m, every_triangle_distance(mesh, topology, q)) << q.transpose();
    const Vec3 end = -random.uniform() * q;
    const auto crossing = surface->first_crossing(q, end);
    const auto expected = every_triangle_crossing(mesh, topology, q, end);
    ASSERT_EQ(crossing ? crossing->fraction : -1.0, expected.value_or(-1.0)) << q.transpose();
  }
}

TEST(EmbreeSurface, QueriesFarBeyondFloat) {
  const TriangleMesh mesh = cube(0.01);
  const auto surface = make_embree_surface(mesh);
  const MeshTopology topology = make_topology(mesh);
  for (const double distance : {1e3, 1e5, 1e12}) {
    const Vec3 q(distance, 0.3 * distance, -0.2 * distance);
    EXPECT_EQ(surface->closest(q).distance_m, every_triangle_distance(mesh, topology, q));
    EXPECT_TRUE(surface->first_crossing(q, -q));
  }
}

TEST(EmbreeSurface, SegmentsThroughEdgesAndVerticesAreNotMissed) {
  const TriangleMesh mesh = cube(1.0);
  const auto surface = make_embree_surface(mesh);
  Random random(5);
  for (const Vec3& v : mesh.vertices_W_m) {
    for (int i = 0; i < 100; ++i) {
      const Vec3 inside = 0.9 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      EXPECT_TRUE(surface->first_crossing(v + (v - inside), inside));
    }
  }
  // Along the diagonals that divide the faces, and from joint to joint of a path whose joint lies on the surface.
  EXPECT_TRUE(surface->first_crossing({0.25, 0.25, 2.0}, {0.25, 0.25, 0.0}));
  EXPECT_FALSE(surface->first_crossing({0.25, 0.25, 2.0}, {0.25, 0.25, 1.0}));
  const auto crossing = surface->first_crossing({0.25, 0.25, 1.0}, {0.25, 0.25, 0.0});
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->fraction, 0.0);
  EXPECT_TRUE(crossing->entering);
  const auto out = surface->first_crossing({0.25, 0.25, 1.0}, {0.25, 0.25, 3.0});
  ASSERT_TRUE(out);
  EXPECT_FALSE(out->entering);
}

TEST(EmbreeSurface, SignAndFeatureAtACube) {
  const auto surface = make_embree_surface(cube(1.0));
  EXPECT_DOUBLE_EQ(surface->signed_distance({0.1, 0.2, 0.0}), -0.8);
  EXPECT_DOUBLE_EQ(surface->signed_distance({3.0, 0.2, 0.1}), 2.0);
  const SurfacePoint corner = surface->closest({2.0, 2.0, 2.0});
  EXPECT_EQ(corner.feature, Feature::vertex);
  EXPECT_LT((corner.n_W - Vec3::Ones().normalized()).norm(), 1e-15);
  const SurfacePoint edge = surface->closest({2.0, 2.0, 0.3});
  EXPECT_EQ(edge.feature, Feature::edge);
  EXPECT_LT((edge.n_W - Vec3(1, 1, 0).normalized()).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(edge.signed_distance_m, std::sqrt(2.0));
}

TEST(EmbreeSurface, RepeatedVerticesDoNotTearTheSurface) {
  TriangleMesh torn;
  const TriangleMesh whole = ball(1.0, 3);
  for (const auto& triangle : whole.triangles) {
    const auto n = static_cast<std::int32_t>(torn.vertices_W_m.size());
    for (const auto corner : triangle)
      torn.vertices_W_m.push_back(whole.vertices_W_m[static_cast<std::size_t>(corner)]);
    torn.triangles.push_back({n, n + 1, n + 2});
  }
  const auto a = make_embree_surface(torn);
  const auto b = make_embree_surface(whole);
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 q = random.log_uniform(0.1, 10.0) * random.direction();
    EXPECT_EQ(a->signed_distance(q), b->signed_distance(q));
  }
}

TEST(EmbreeSurface, NumbersThatAreNotFinite) {
  const auto surface = make_embree_surface(cube(1.0));
  const double nan = std::nan("");
  EXPECT_TRUE(std::isnan(surface->closest({nan, 0, 0}).distance_m));
  EXPECT_EQ(surface->closest({0, std::numeric_limits<double>::infinity(), 0}).triangle, -1);
  EXPECT_FALSE(surface->first_crossing({nan, 0, 0}, {0, 0, 0}));
}

TEST(EmbreeSurface, RefusesWhatIsNoSurface) {
  EXPECT_THROW(make_embree_surface(TriangleMesh{}), BadData);
  TriangleMesh wrong = cube(1.0);
  wrong.triangles[3][1] = 8;
  EXPECT_THROW(make_embree_surface(wrong), BadData);
}

// All of them share one device of Embree's: it starts no more than some three hundred.
TEST(EmbreeSurface, AThousandLiveAtOnce) {
  const TriangleMesh mesh = cube(0.02);
  std::vector<std::shared_ptr<Surface>> surfaces;
  surfaces.reserve(1000);
  for (int i = 0; i < 1000; ++i) {
    surfaces.push_back(make_embree_surface(moved(mesh, Quat::Identity(), Vec3(0.1 * i, 0.0, 0.0))));
  }
  for (int i = 0; i < 1000; ++i) {
    const Vec3 middle(0.1 * i, 0.0, 0.0);
    EXPECT_NEAR(surfaces[static_cast<std::size_t>(i)]->closest(middle + Vec3(0.05, 0.0, 0.0)).distance_m, 0.03, 1e-12);
  }
}

}  // namespace
}  // namespace touchstone::surface
