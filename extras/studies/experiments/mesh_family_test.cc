#include "experiments/mesh_family.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/progress.h"
#include "harness/base/random.h"
#include "harness/surface/mesh_doctor.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::experiments {
using surface::TriangleMesh;

namespace {

// A body with a neck and bumps, scanned with the noise of a scanner: quadrics alone fold it.
TriangleMesh scanned_body(std::uint64_t seed) {
  TriangleMesh mesh = testing::ball(0.04, 6);
  Random random(seed);
  for (Vec3& v : mesh.vertices_W_m) {
    const Vec3 n = v.normalized();
    const double neck = 1.0 - 0.45 * std::exp(-std::pow((n.z() - 0.35) / 0.12, 2));
    const double bumps = 1.0 + 0.03 * std::sin(14.0 * n.x()) * std::cos(11.0 * n.y());
    v = Vec3(v.x() * neck, v.y() * neck, 1.4 * v.z()) * bumps + 2e-5 * random.normal() * n;
  }
  return mesh;
}

TEST(MeshFamily, DecimationFoldsNothing) {
  for (const std::uint64_t seed : {1u, 2u}) {
    const auto family = decimated_family(scanned_body(seed), {12000, 6000, 3000, 1500, 700});
    for (const TriangleMesh& mesh : family) {
      const auto diagnosis = surface::examine_mesh(mesh, {}, {});
      for (const auto& finding : diagnosis.findings) EXPECT_NE(finding.name, "folds") << mesh.source << finding.what;
      EXPECT_EQ(diagnosis.open_edges, 0U) << mesh.source;
    }
  }
}

TEST(MeshFamily, EndsWhenAskedTo) {
  ask_to_stop();
  EXPECT_THROW(decimated_family(testing::ball(0.04, 5), {3000}), Stopped);
  allow_work();
}

}  // namespace
}  // namespace touchstone::experiments
