// From a hand's target to a point on a surface: the contact that a scan prescribes, exact because each surface is
// evaluated, not searched, where it can be.
#pragma once

#include "synthetic/surfaces/analytic_surface.h"
#include "synthetic/surfaces/height_field.h"
#include "synthetic/surfaces/radial_body.h"

namespace touchstone::datasets {

struct GuidePoint {
  Vec3 p_W_m;  // on the surface
  Vec3 n_W;    // outward, towards the ball's centre
};

class Guide {
 public:
  virtual ~Guide() = default;
  [[nodiscard]] virtual GuidePoint at(const Vec3& target) const = 0;
};

// The target's x and y in metres; z is not used.
class HeightFieldGuide final : public Guide {
 public:
  explicit HeightFieldGuide(const synthetic::HeightField& surface) : surface_(&surface) {}
  [[nodiscard]] GuidePoint at(const Vec3& target) const override;

 private:
  const synthetic::HeightField* surface_;
};

// The target's direction from the origin; its length is not used.
class RadialGuide final : public Guide {
 public:
  explicit RadialGuide(const synthetic::RadialBody& surface) : surface_(&surface) {}
  [[nodiscard]] GuidePoint at(const Vec3& target) const override;

 private:
  const synthetic::RadialBody* surface_;
};

// The surface's closest point to a target outside of it, in metres; throws UsageError for a target inside. A ball kept
// on that line touches there also at an edge: it rolls over it.
class ClosestPointGuide final : public Guide {
 public:
  explicit ClosestPointGuide(const surface::Surface& surface) : surface_(&surface) {}
  [[nodiscard]] GuidePoint at(const Vec3& target) const override;

 private:
  const surface::Surface* surface_;
};

}  // namespace touchstone::datasets
