#include "harness/surface/facet_angle.h"

#include <algorithm>
#include <cmath>

#include "harness/stats/quantile.h"

namespace touchstone::surface {

double median_facet_angle_rad(const TriangleMesh& mesh, std::span<const std::int32_t> triangles) {
  std::vector<Vec3> corner_normals(mesh.vertices_W_m.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (const std::int32_t v : mesh.triangles[t]) corner_normals[static_cast<std::size_t>(v)] += mesh.scaled_normal(t);
  }
  std::vector<double> angles;
  angles.reserve(triangles.size());
  for (const std::int32_t triangle : triangles) {
    const auto t = static_cast<std::size_t>(triangle);
    const Vec3 facet = mesh.scaled_normal(t);
    double sum = 0.0;
    for (const std::int32_t v : mesh.triangles[t]) {
      const Vec3& corner = corner_normals[static_cast<std::size_t>(v)];
      sum += std::atan2(facet.cross(corner).norm(), facet.dot(corner));
    }
    angles.push_back(sum / 6.0);
  }
  if (angles.empty()) return 0.0;
  return stats::upper_median(std::move(angles));
}

}  // namespace touchstone::surface
