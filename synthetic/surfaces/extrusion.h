// A block whose top follows a profile in x and z, the same for every y: steps, wedges, grooves, creases, shells, slots.
// Closed form: distance of a plane region extended by a flat cap at either end, exact inside and outside.
#pragma once

#include "synthetic/surfaces/analytic_surface.h"
#include "synthetic/surfaces/profile.h"

namespace touchstone::synthetic {

class Extrusion final : public AnalyticSurface {
 public:
  // The top's corners from the right (largest x) to the left, x never increasing: no overhang. The block reaches down
  // to floor_z_m, which lies below the whole top, and over |y| <= half_width_m.
  Extrusion(const std::vector<Corner>& top, double floor_z_m, double half_width_m);

  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p_W_m) const override;
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override;
  [[nodiscard]] Box3 bounds() const override;
  // Without edge radii the mesh is exact at every count.
  [[nodiscard]] Tessellation tessellate(std::size_t triangles) const override;
  [[nodiscard]] bool closed() const noexcept override { return true; }

 private:
  Profile top_;
  Profile outline_;
  double floor_z_m_;
  double half_width_m_;
};

}  // namespace touchstone::synthetic
