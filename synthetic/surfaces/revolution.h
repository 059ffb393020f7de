// A solid of revolution about z: spheres, cylinders, tori, rounded or sharp bumps. In the half-plane through the query
// point the closest point is the profile's, hence closed form and exact. Crossings: planes, cones and spheres are
// quadratics, tori quartics along a segment.
#pragma once

#include "synthetic/surfaces/analytic_surface.h"
#include "synthetic/surfaces/profile.h"

namespace touchstone::synthetic {

class Revolution final : public AnalyticSurface {
 public:
  // The profile (s, z) with s >= 0 the distance from the axis: either closed, or open from the axis to the axis. With
  // the outside on the right of its travel: upwards (from the lower pole to the upper).
  explicit Revolution(Profile profile);

  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p_W_m) const override;
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override;
  [[nodiscard]] Box3 bounds() const override;
  [[nodiscard]] Tessellation tessellate(std::size_t triangles) const override;
  [[nodiscard]] bool closed() const noexcept override { return true; }

 private:
  Profile profile_;
};

}  // namespace touchstone::synthetic
