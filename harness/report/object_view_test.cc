#include "harness/report/object_view.h"

#include "harness/report/sample_result_for_test.h"

namespace touchstone::report {
using surface::TriangleMesh;

namespace {

double area(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) sum += 0.5 * mesh.scaled_normal(i).norm();
  return sum;
}

TriangleMesh square(double size) {
  TriangleMesh mesh;
  mesh.vertices_W_m = {{0, 0, 0}, {size, 0, 0}, {size, size, 0}, {0, size, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(ObjectView, SplittingKeepsTheShapeAndReachesTheDetail) {
  for (const double size : {1e-3, 1.0, 1e3}) {
    const TriangleMesh mesh = square(size);
    const TriangleMesh drawn = drawn_mesh(mesh, mesh.bounds(), size / 20.0);
    EXPECT_NEAR(area(drawn), size * size, 1e-12 * size * size);
    for (const auto& t : drawn.triangles) {
      for (std::size_t e = 0; e < 3; ++e) {
        const Vec3 edge = drawn.vertices_W_m[static_cast<std::size_t>(t[e])] -
                          drawn.vertices_W_m[static_cast<std::size_t>(t[(e + 1) % 3])];
        EXPECT_LE(edge.norm(), size / 20.0);
      }
    }
    EXPECT_LT(drawn.triangles.size(), 10'000u);
  }
}

TEST(ObjectView, StaysBelowTheLimitBothWays) {
  const TriangleMesh sphere = sample_sphere(0.03, 100);
  ASSERT_EQ(sphere.triangles.size(), 40'000u);
  const TriangleMesh thin = drawn_mesh(sphere, sphere.bounds(), 1e-5, 10'000);
  EXPECT_LE(thin.triangles.size(), 10'000u);
  EXPECT_GT(thin.triangles.size(), 5'000u);
  EXPECT_NEAR(area(thin), area(sphere), 0.02 * area(sphere));
}

TEST(ObjectView, ErrorWhereItWasAndNothingElsewhere) {
  const TriangleMesh mesh = square(1.0);
  metrics::ErrorMap errors(0.02);
  Box3 touched;
  for (int i = 0; i <= 100; ++i) {
    const Vec3 p(0.25 + 0.005 * i, 0.5, 0.0);
    errors.add(p, 3.0);
    touched.extend(p);
  }
  const ObjectView view = object_view(mesh, errors, touched, 0.02);
  int known = 0;
  for (std::size_t i = 0; i < view.error.size(); ++i) {
    const bool near = std::abs(view.vertices_W_m[i].y() - 0.5) < 0.05;
    if (!std::isnan(view.error[i])) {
      ++known;
      EXPECT_NEAR(view.error[i], 3.0, 1e-12);
      EXPECT_TRUE(near) << view.vertices_W_m[i].transpose();
    }
  }
  EXPECT_GT(known, 50);
}

}  // namespace
}  // namespace touchstone::report
