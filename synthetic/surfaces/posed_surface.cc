#include "synthetic/surfaces/posed_surface.h"

namespace touchstone::synthetic {

surface::SurfacePoint PosedSurface::closest(const Vec3& p) const {
  surface::SurfacePoint at = body_->closest(to_body(p));
  at.p_W_m = to_world(at.p_W_m);
  at.n_W = rotation_ * at.n_W;
  return at;
}

std::optional<surface::Crossing> PosedSurface::first_crossing(const Vec3& a, const Vec3& b) const {
  std::optional<surface::Crossing> crossing = body_->first_crossing(to_body(a), to_body(b));
  if (crossing) {
    crossing->p_W_m = to_world(crossing->p_W_m);
    crossing->n_W = rotation_ * crossing->n_W;
  }
  return crossing;
}

Box3 PosedSurface::bounds() const {
  const Box3 body = body_->bounds();
  Box3 box;
  for (int i = 0; i < 8; ++i) box.extend(to_world(body.corner(static_cast<Box3::CornerType>(i))));
  return box;
}

Tessellation PosedSurface::tessellate(std::size_t triangles) const {
  Tessellation made = body_->tessellate(triangles);
  for (Vec3& v : made.mesh.vertices_W_m) v = to_world(v);
  return made;
}

}  // namespace touchstone::synthetic
