#include "renderers/point_proxy.h"

#include "harness/surface/triangle_queries.h"

namespace touchstone {

void PointProxy::start(const Vec3& p) noexcept {
  by_planes_ = false;
  const SurfacePoint nearest = surface_->closest(p);
  if (!(nearest.signed_distance_m < 0.0)) return walk_.start_free(p);
  const Facet& facet = mesh_->facet(nearest.triangle);
  const TriangleClosest where = closest_on_triangle(mesh_->corners(nearest.triangle), facet.n, p);
  // Beyond the rim of an open mesh there is no inside.
  if (mesh_->on_rim(nearest.triangle, where.feature, where.index)) return walk_.start_free(p);
  if (!walk_.start_on(nearest.triangle, where.feature, where.index, p))
    go_by_planes(nearest.p_W_m, nearest.triangle, p);
}

void PointProxy::follow(const Vec3& p) noexcept {
  if (by_planes_) {
    go_by_planes(planes_.position(), -1, p);
  } else if (!walk_.follow(p)) {
    go_by_planes(walk_.position(), walk_.triangle(), p);
  }
}

void PointProxy::go_by_planes(const Vec3& g, std::int32_t triangle, const Vec3& p) noexcept {
  if (triangle >= 0) planes_.start(g, triangle);
  planes_.follow(p);
  by_planes_ = true;
  if (!planes_.touching()) {
    walk_.start_free(planes_.position());
    by_planes_ = false;
  } else if (const std::int32_t single = planes_.single(); single >= 0 && mesh_->facet(single).regular) {
    // Back on a triangle that can be walked on; from there the walk may stop again, then planes_ stands as it is.
    walk_.resume(planes_.position(), single);
    by_planes_ = !walk_.follow(p);
  }
}

}  // namespace touchstone
