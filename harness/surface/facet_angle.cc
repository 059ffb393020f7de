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

SmoothNormals::SmoothNormals(const TriangleMesh& mesh) : mesh_(mesh), corners_(mesh.triangle_count()) {
  const double least_cosine = std::cos(sharp_rad);
  std::vector<std::vector<std::size_t>> about(mesh.vertices_W_m.size());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (const std::int32_t v : mesh.triangles[t]) about[static_cast<std::size_t>(v)].push_back(t);
  }
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 own = mesh.scaled_normal(t).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 sum = Vec3::Zero();
      for (const std::size_t other : about[static_cast<std::size_t>(mesh.triangles[t][k])]) {
        const Vec3 normal = mesh.scaled_normal(other);
        if (normal.dot(own) >= least_cosine * normal.norm()) sum += normal;
      }
      corners_[t][k] = sum.normalized();
    }
  }
}

Vec3 SmoothNormals::at(std::int32_t triangle, const Vec3& p_W_m) const {
  const auto t = static_cast<std::size_t>(triangle);
  const auto corner = [&](std::size_t k) -> const Vec3& {
    return mesh_.vertices_W_m[static_cast<std::size_t>(mesh_.triangles[t][k])];
  };
  const Vec3 normal = mesh_.scaled_normal(t);
  const double size = normal.squaredNorm();  // the square of twice the area
  if (!(size > 0.0)) return corners_[t][0];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& next = corner((k + 1) % 3);
    const double share = (corner((k + 2) % 3) - next).cross(p_W_m - next).dot(normal) / size;
    sum += std::clamp(share, 0.0, 1.0) * corners_[t][k];
  }
  return sum.normalized();
}

}  // namespace touchstone::surface
