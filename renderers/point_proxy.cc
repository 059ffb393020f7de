#include "renderers/point_proxy.h"

#include "harness/surface/triangle_queries.h"
#include "renderers/front_crossing.h"

namespace touchstone {

StartPlace start_place(const ContactMesh& mesh, const Surface& surface, const Vec3& p) noexcept {
  const SurfacePoint nearest = surface.closest(p);
  if (!(nearest.signed_distance_m < 0.0)) return {};
  const Facet& facet = mesh.facet(nearest.triangle);
  const TriangleClosest where = closest_on_triangle(mesh.corners(nearest.triangle), facet.n, p);
  // Beyond the rim of an open mesh there is no inside.
  if (mesh.on_rim(nearest.triangle, where.feature, where.index)) return {};
  return {true, nearest.triangle, where.feature, where.index, nearest.p_W_m};
}

void PointProxy::start(const Vec3& p) noexcept {
  by_planes_ = false;
  cone_.stick();
  const StartPlace place = start_place(*mesh_, *surface_, p);
  if (!place.inside) return walk_.start_free(p);
  if (!walk_.start_on(place.triangle, place.feature, place.index, p)) go_by_planes(place.p_W_m, place.triangle, p);
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
  if (cone_.friction().none()) {
    planes_.pull(p);
  } else {
    cone_.follow(planes_, p, resting_error(*mesh_, g));
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

}  // namespace touchstone
