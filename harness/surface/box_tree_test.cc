#include "harness/surface/box_tree.h"

#include <gtest/gtest.h>

#include <set>

#include "harness/base/counted.h"
#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_topology.h"
#include "harness/surface/triangle_queries.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::surface {
namespace {

template <class S>
std::array<Vec3Of<S>, 3> corners_of(const TriangleMesh& mesh, std::size_t t) {
  std::array<Vec3Of<S>, 3> corners;
  for (std::size_t c = 0; c < 3; ++c)
    corners[c] = mesh.vertices_W_m[static_cast<std::size_t>(mesh.triangles[t][c])].cast<S>();
  return corners;
}

// The closest triangle and distance by the tree, with either scalar.
template <class S>
std::pair<std::int32_t, double> nearest_by(const BoxTree& tree, const TriangleMesh& mesh, const MeshTopology& topology,
                                           const Vec3& q_m) {
  const Vec3Of<S>& q = q_m.cast<S>();
  std::int32_t nearest = -1;
  S least(0.0);
  tree.nearest<S>(q, [&](std::int32_t t) {
    const auto corners = corners_of<S>(mesh, static_cast<std::size_t>(t));
    const Vec3Of<S> n = topology.face_normals[static_cast<std::size_t>(t)].cast<S>();
    const S here = closest_on_triangle_of<S>(corners, n, q).squared_distance;
    if (nearest < 0 || here < least || (here == least && t < nearest)) {
      nearest = t;
      least = here;
    }
    return least;
  });
  return {nearest, static_cast<double>(least)};
}

// At a unit of length.
class BoxTreeOn : public ::testing::TestWithParam<double> {
 protected:
  static TriangleMesh moved_torus() {
    return moved(testing::torus(0.02, 0.008, 40, 20), Quat::Identity(), GetParam() * Vec3(0.1, 0.2, -0.3), GetParam());
  }
};

TEST_P(BoxTreeOn, FindsTheClosestTriangleOfTheSurfaceWithEitherScalar) {
  for (const TriangleMesh& shape :
       {testing::torus(0.02, 0.008, 40, 20), testing::cube(0.02), testing::grid(0.02, 30)}) {
    const TriangleMesh mesh =
        moved(shape, Quat(0.83, 0.31, -0.41, 0.22).normalized(), GetParam() * Vec3(0.1, 0.2, -0.3), GetParam());
    const BoxTree tree(mesh);
    const MeshTopology topology = make_topology(mesh);
    const auto surface = make_embree_surface(mesh);
    Random random(1);
    for (int i = 0; i < 500; ++i) {
      const Vec3 q = surface->bounds().center() + GetParam() * random.log_uniform(1e-3, 0.3) * random.direction();
      const SurfacePoint expected = surface->closest(q);
      const auto [t, square] = nearest_by<double>(tree, mesh, topology, q);
      ASSERT_EQ(t, expected.triangle);
      ASSERT_EQ(std::sqrt(square), expected.distance_m);
      const OperationCounts before = operations_on_this_thread();
      ASSERT_EQ(nearest_by<Counted>(tree, mesh, topology, q), std::pair(t, square));
      const OperationCounts counts = operations_on_this_thread() - before;
      ASSERT_GT(counts.total(), 20U);
    }
  }
}

TEST_P(BoxTreeOn, ProposesEveryTriangleThatASegmentMeets) {
  const TriangleMesh mesh = moved_torus();
  const BoxTree tree(mesh);
  Random random(2);
  std::size_t met = 0;
  std::size_t proposed = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = GetParam() * (Vec3(0.1, 0.2, -0.3) + 0.03 * random.direction());
    Vec3 b = GetParam() * (Vec3(0.1, 0.2, -0.3) + random.log_uniform(1e-4, 0.03) * random.direction());
    if (i % 5 == 0) b.x() = a.x();  // within a plane of the axes
    std::set<std::int32_t> candidates;
    tree.along_segment<double>(a, b, [&](std::int32_t t) {
      candidates.insert(t);
      return 1.0;
    });
    proposed += candidates.size();
    std::size_t counted = 0;
    tree.along_segment<Counted>(a.cast<Counted>(), b.cast<Counted>(), [&](std::int32_t) {
      ++counted;
      return Counted(1.0);
    });
    ASSERT_EQ(counted, candidates.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto corners = corners_of<double>(mesh, t);
      if (!cross_triangle(corners, mesh.scaled_normal(t).normalized(), a, b)) continue;
      ++met;
      ASSERT_TRUE(candidates.contains(static_cast<std::int32_t>(t)));
    }
  }
  EXPECT_GT(met, 100U);
  EXPECT_LT(proposed, 300U * mesh.triangle_count() / 10U) << "it must leave most triangles out";
}

TEST_P(BoxTreeOn, ProposesEveryTriangleWithinABall) {
  const TriangleMesh mesh = moved_torus();
  const BoxTree tree(mesh);
  Random random(3);
  std::size_t within = 0;
  std::size_t proposed = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 q = GetParam() * (Vec3(0.1, 0.2, -0.3) + 0.03 * random.direction());
    const double radius = GetParam() * random.log_uniform(1e-4, 0.03);
    std::set<std::int32_t> candidates;
    tree.within<double>(q, radius, [&](std::int32_t t) {
      candidates.insert(t);
      return radius;
    });
    proposed += candidates.size();
    std::size_t counted = 0;
    tree.within<Counted>(q.cast<Counted>(), Counted(radius), [&](std::int32_t) {
      ++counted;
      return Counted(radius);
    });
    ASSERT_EQ(counted, candidates.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto corners = corners_of<double>(mesh, t);
      const auto closest = closest_on_triangle(corners, mesh.scaled_normal(t).normalized(), q);
      if (!(closest.squared_distance <= radius * radius)) continue;
      ++within;
      ASSERT_TRUE(candidates.contains(static_cast<std::int32_t>(t)));
    }
  }
  EXPECT_GT(within, 1000U);
  EXPECT_LT(proposed, 4 * within + 2000U) << "it must leave most triangles out";
}

INSTANTIATE_TEST_SUITE_P(Scales, BoxTreeOn, ::testing::Values(1e-3, 1.0, 1e3),
                         [](const auto& of) { return "Scale" + std::to_string(of.index); });

}  // namespace
}  // namespace touchstone::surface
