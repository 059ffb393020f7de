#include "guide.h"

#include <fmt/format.h>

#include "harness/base/error.h"

namespace touchstone::datasets {
using synthetic::HeightField;

GuidePoint HeightFieldGuide::at(const Vec3& target) const {
  const HeightField::Height h = surface_->height(target.x(), target.y());
  return {{target.x(), target.y(), h.z}, Vec3(-h.slope.x(), -h.slope.y(), 1.0).normalized()};
}

GuidePoint RadialGuide::at(const Vec3& target) const {
  const Vec3 u = target.normalized();
  return {surface_->point_W_m(u), surface_->normal_W(u)};
}

GuidePoint ClosestPointGuide::at(const Vec3& target) const {
  const surface::SurfacePoint q = surface_->closest(target);
  if (!(q.signed_distance_m > 0.0)) {
    throw UsageError(fmt::format("a scan is guided along the outside, but ({}, {}, {}) m is {} m inside the surface",
                                 target.x(), target.y(), target.z(), -q.signed_distance_m));
  }
  return {q.p_W_m, (target - q.p_W_m) / q.distance_m};
}

}  // namespace touchstone::datasets
