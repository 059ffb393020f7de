#include "synthetic/surfaces/sphere.h"

#include <cmath>

#include "synthetic/surfaces/crossing.h"
#include "synthetic/surfaces/icosphere.h"

namespace touchstone::synthetic {

surface::SurfacePoint Sphere::closest(const Vec3& p) const {
  const double r = p.norm();
  const Vec3 n = r > 0.0 ? Vec3(p / r) : Vec3(Vec3::UnitZ());
  return analytic_point(radius_m_ * n, n, r - radius_m_);
}

std::optional<surface::Crossing> Sphere::first_crossing(const Vec3& a, const Vec3& b) const {
  CrossingCandidates candidates;
  const Vec3 d = b - a;
  candidates.offer_quadratic(a.squaredNorm() - radius_m_ * radius_m_, 2.0 * a.dot(d), d.squaredNorm());
  return candidates.first(*this, a, b);
}

Box3 Sphere::bounds() const { return {Vec3::Constant(-radius_m_), Vec3::Constant(radius_m_)}; }

Tessellation Sphere::tessellate(std::size_t triangles) const {
  Tessellation result{icosphere(triangles, [this](const Vec3&) { return radius_m_; }), 0.0};
  // A triangle with its corners on the sphere dips by R - sqrt(R^2 - c^2), c its circumradius; an acute one with sides
  // up to L has c <= L / sqrt 3. Written without the difference of nearly equal numbers.
  const double edge = longest_edge_m(result.mesh);
  const double c2 = edge * edge / 3.0;
  result.deviation_bound_m = c2 / (radius_m_ + std::sqrt(std::max(0.0, radius_m_ * radius_m_ - c2)));
  return result;
}

}  // namespace touchstone::synthetic
