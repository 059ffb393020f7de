// Open patches z = h(x, y), inside below: what all of them share. A concrete one says its height and slope, a bound on
// its second derivative, and the foot of the perpendicular from a point.
#pragma once

#include "synthetic/surfaces/analytic_surface.h"
#include "synthetic/surfaces/profile.h"

namespace touchstone::synthetic {

class HeightField : public AnalyticSurface {
 public:
  struct Height {
    double z;
    Vec2 slope;  // dz/dx, dz/dy
  };

  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p_W_m) const final;
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const final;
  // Of the patch that the mesh covers; the surface goes on beyond it.
  [[nodiscard]] Box3 bounds() const final;
  // A grid of squares (as near as the count allows) with alternating diagonals.
  [[nodiscard]] Tessellation tessellate(std::size_t triangles) const final;
  [[nodiscard]] bool closed() const noexcept final { return false; }
  [[nodiscard]] virtual Height height(double x_m, double y_m) const = 0;

 protected:
  explicit HeightField(double half_side_m) : half_side_m_(half_side_m) {}
  // |d^2 h / d t^2| along the vector d is at most this, everywhere.
  [[nodiscard]] virtual double second_derivative_bound(const Vec2& d) const = 0;
  // x and y of the closest point on the graph.
  [[nodiscard]] virtual Vec2 foot(const Vec3& p_W_m) const = 0;
  // The lowest and highest z over the patch.
  [[nodiscard]] virtual std::pair<double, double> range() const = 0;
  [[nodiscard]] double half_side_m() const noexcept { return half_side_m_; }

 private:
  double half_side_m_;
};

}  // namespace touchstone::synthetic
