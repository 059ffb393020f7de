// The plane z = 0 in the worst triangles: nested squares down to a tiny one, every second gap between them a sliver.
// The exact answers are the plane's; what a renderer makes of it shows its absolute epsilons.
#pragma once

#include "synthetic/surfaces/height_fields.h"

namespace touchstone::synthetic {

class SliverPatch final : public AnalyticSurface {
 public:
  // `aspect`: length over width of the slivers; smallest_m: side of the innermost square.
  SliverPatch(double half_side_m, double smallest_m, double aspect)
      : plane_(half_side_m), half_side_m_(half_side_m), smallest_m_(smallest_m), aspect_(aspect) {}

  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p_W_m) const override { return plane_.closest(p_W_m); }
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override {
    return plane_.first_crossing(a_W_m, b_W_m);
  }
  [[nodiscard]] Box3 bounds() const override { return plane_.bounds(); }
  [[nodiscard]] Tessellation tessellate(std::size_t triangles) const override;
  [[nodiscard]] bool closed() const noexcept override { return false; }

 private:
  Plane plane_;
  double half_side_m_;
  double smallest_m_;
  double aspect_;
};

}  // namespace touchstone::synthetic
