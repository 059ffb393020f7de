// A ball about the origin: the simplest exact answer there is.
#pragma once

#include "synthetic/surfaces/analytic_surface.h"

namespace touchstone::synthetic {

class Sphere final : public AnalyticSurface {
 public:
  explicit Sphere(double radius_m) : radius_m_(radius_m) {}

  // At the centre every point is as close: +z is taken.
  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p_W_m) const override;
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override;
  [[nodiscard]] Box3 bounds() const override;
  // An icosphere: triangles of nearly equal size.
  [[nodiscard]] Tessellation tessellate(std::size_t triangles) const override;
  [[nodiscard]] bool closed() const noexcept override { return true; }

 private:
  double radius_m_;
};

}  // namespace touchstone::synthetic
