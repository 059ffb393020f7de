#include "synthetic/surfaces/height_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "synthetic/surfaces/roots.h"

namespace touchstone::synthetic {
using surface::Crossing;

surface::SurfacePoint HeightField::closest(const Vec3& p) const {
  const Vec2 xy = foot(p);
  const Height at = height(xy.x(), xy.y());
  const Vec3 q(xy.x(), xy.y(), at.z);
  const bool inside = p.z() < height(p.x(), p.y()).z;
  const double distance = inside ? -(p - q).norm() : (p - q).norm();
  const Vec3 n = Vec3(-at.slope.x(), -at.slope.y(), 1.0).normalized();
  const double curvature = std::max(second_derivative_bound({1.0, 0.0}), second_derivative_bound({0.0, 1.0}));
  return analytic_point(q, searched_normal(p, q, n, distance, curvature), distance);
}

std::optional<Crossing> HeightField::first_crossing(const Vec3& a, const Vec3& b) const {
  const Vec3 d = b - a;
  const Vec2 d_xy(d.x(), d.y());
  // How far the segment's point at t is above the field: f(t) = z_a + t d_z - h(xy_a + t d_xy), with
  // f' = d_z - grad h . d_xy and f'' = -d_xy' H d_xy, H the matrix of h's second derivatives, which the field bounds.
  // The search needs that bound to know where no root can be, and the rounding of f, whose terms are of the size of
  // the coordinates, to know when a value is zero.
  const auto above = [&](double t) {
    const Height at = height(a.x() + t * d.x(), a.y() + t * d.y());
    return Jet1{a.z() + t * d.z() - at.z, d.z() - at.slope.dot(d_xy)};
  };
  const double size = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()});
  const double noise = 8.0 * std::numeric_limits<double>::epsilon() * size;
  std::optional<Crossing> crossing;
  visit_sign_changes(above, 0.0, 1.0, second_derivative_bound(d_xy), noise, [&](double t, bool downward) {
    const double x = a.x() + t * d.x();
    const double y = a.y() + t * d.y();
    const Height at = height(x, y);
    crossing = Crossing{t, {x, y, at.z}, Vec3(-at.slope.x(), -at.slope.y(), 1.0).normalized(), downward, -1};
    return true;
  });
  return crossing;
}

Box3 HeightField::bounds() const {
  const auto [low, high] = range();
  return {Vec3(-half_side_m_, -half_side_m_, low), Vec3(half_side_m_, half_side_m_, high)};
}

Tessellation HeightField::tessellate(std::size_t triangles) const {
  const double cells = std::max(1.0, static_cast<double>(triangles) / 2.0);
  const auto nx = static_cast<std::int32_t>(std::max(1.0, std::round(std::sqrt(cells))));
  const auto ny = static_cast<std::int32_t>(std::max(1.0, std::round(cells / nx)));
  surface::TriangleMesh mesh;
  mesh.vertices_W_m.reserve(static_cast<std::size_t>(nx + 1) * static_cast<std::size_t>(ny + 1));
  for (std::int32_t j = 0; j <= ny; ++j) {
    for (std::int32_t i = 0; i <= nx; ++i) {
      const double x = half_side_m_ * (2.0 * i / nx - 1.0);
      const double y = half_side_m_ * (2.0 * j / ny - 1.0);
      mesh.vertices_W_m.emplace_back(x, y, height(x, y).z);
    }
  }
  mesh.triangles.reserve(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * 2);
  for (std::int32_t j = 0; j < ny; ++j) {
    for (std::int32_t i = 0; i < nx; ++i) {
      const std::int32_t a = j * (nx + 1) + i;
      const std::int32_t b = a + 1;
      const std::int32_t c = a + nx + 1;
      const std::int32_t d = c + 1;
      if ((i + j) % 2 == 0) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({b, d, c});
      }
    }
  }
  // Linear interpolation on a triangle errs by at most |h''| R^2 / 2, R the radius of the smallest circle around it
  // (Waldron 1998): here half the cell's diagonal. Taken direction by direction, as texture bends along one only.
  const double dx = 2.0 * half_side_m_ / nx;
  const double dy = 2.0 * half_side_m_ / ny;
  const double bound = (second_derivative_bound({dx, 0.0}) + second_derivative_bound({0.0, dy})) / 8.0;
  return {std::move(mesh), bound};
}

}  // namespace touchstone::synthetic
