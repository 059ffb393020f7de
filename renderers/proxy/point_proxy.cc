#include "renderers/proxy/point_proxy.h"

#include "renderers/mesh_traversal/front_crossing.h"

namespace touchstone::renderers {

void PointProxy::start(const Vec3& p) noexcept {
  by_planes_ = false;
  cone_.stick();
  const StartPlace place = start_place(*mesh_, *surface_, p);
  if (!place.inside) return walk_.start_free(p);
  if (walk_.start_on(place.triangle, place.feature, place.index, p)) return;
  planes_.start_on(place.triangle, place.p_W_m);
  go_by_planes(p);
}

void PointProxy::follow(const Vec3& p) noexcept {
  if (!by_planes_) {
    if (walk_.follow(p)) return;
    cone_.resume(walk_.sliding());
    if (walk_.flew()) {
      planes_.start_free(walk_.took_off());
    } else {
      planes_.start_on(walk_.triangle(), walk_.position());
    }
  }
  go_by_planes(p);
}

void PointProxy::go_by_planes(const Vec3& p) noexcept {
  if (cone_.friction().none()) {
    planes_.pull(p);
  } else {
    cone_.follow(planes_, p, resting_error(*mesh_, planes_.position()));
  }
  by_planes_ = true;
  if (!planes_.touching()) {
    walk_.start_free(planes_.position());
    by_planes_ = false;
  } else if (const std::int32_t single = planes_.single(); single >= 0 && mesh_->facet(single).regular) {
    // Back on a triangle that can be walked on; from there the walk may stop again, then planes_ stands as it is.
    walk_.resume(planes_.position(), single, cone_.sliding());
    by_planes_ = !walk_.follow(p);
  }
}

Vec3 PointProxy::normal(const Vec3& p) const noexcept {
  if (!by_planes_) return walk_.normal();
  return cone_.friction().none() ? planes_.normal(p)
                                 : cone_normal(planes_, p, resting_error(*mesh_, planes_.position()));
}

}  // namespace touchstone::renderers
