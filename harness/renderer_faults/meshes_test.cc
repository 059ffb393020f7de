#include "harness/renderer_faults/meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "harness/surface/box_mesh.h"
#include "harness/surface/moved_mesh.h"
#include "harness/surface/sphere_mesh.h"

namespace touchstone::renderer_faults {
namespace {

// Of a closed outward mesh: Gauss.
double volume(const surface::TriangleMesh& mesh) {
  double six = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](std::int32_t i) { return mesh.vertices_W_m[static_cast<std::size_t>(i)]; };
    six += at(a).dot(at(b).cross(at(c)));
  }
  return six / 6.0;
}

bool closed(const surface::TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ++edges[{t[i], t[(i + 1) % 3]}];
      --edges[{t[(i + 1) % 3], t[i]}];
    }
  }
  for (const auto& [edge, balance] : edges) {
    if (balance != 0) return false;
  }
  return true;
}

TEST(DiagnosisMeshes, BodiesAreClosedAndOutward) {
  const auto box = surface::box_mesh({-1, -2, -3}, {1, 2, 0});
  EXPECT_TRUE(closed(box));
  EXPECT_NEAR(volume(box), 24.0, 1e-12);
  EXPECT_TRUE(closed(together(box, box)));
  EXPECT_NEAR(volume(together(box, box)), 48.0, 1e-12);
  for (const double angle : {0.0, 0.3, -0.3}) {
    const auto two = roof(1.0, angle);
    EXPECT_TRUE(closed(two)) << angle;
    EXPECT_NEAR(volume(two), 4.0 - std::tan(angle), 1e-12) << angle;
  }
  EXPECT_TRUE(closed(surface::sphere_mesh(1.0, 3)));
  // Corners on the sphere: a little less than it, and a quarter of that with the next refinement.
  const double ball = 4.0 / 3.0 * M_PI;
  EXPECT_NEAR((ball - volume(surface::sphere_mesh(1.0, 3))) / (ball - volume(surface::sphere_mesh(1.0, 4))), 4.0, 0.05);
  EXPECT_LT(volume(surface::sphere_mesh(1.0, 4)), ball);
  EXPECT_NEAR(volume(moved(box, Quat(0.8, 0.6, 0, 0), {5, 6, 7}, 0.5)), 3.0, 1e-12);
}

TEST(DiagnosisMeshes, NestedSquaresCoverTheSheetWithoutSlivers) {
  for (const double smallest : {0.02, 1e-3, 1e-7}) {
    const auto sheet = nested_sheet(0.02, smallest);
    double area = 0.0;
    double least = 1.0;
    for (std::size_t t = 0; t < sheet.triangle_count(); ++t) {
      const Vec3 n = sheet.scaled_normal(t);
      EXPECT_GT(n.z(), 0.0);
      area += 0.5 * n.z();
      least = std::min(least, std::sqrt(n.z()));
    }
    EXPECT_NEAR(area, 0.04 * 0.04, 1e-15);
    EXPECT_LE(least, smallest);
    EXPECT_GT(least, 0.4 * smallest);
  }
}

}  // namespace
}  // namespace touchstone::renderer_faults
