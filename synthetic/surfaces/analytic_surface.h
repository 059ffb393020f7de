// A surface known in closed form together with its honest tessellation: what every generator of shapes returns.
// Frames and units: object frame W, metres. Open shapes (plane, saddle, ...) are graphs z = h(x, y) that extend beyond
// the patch which their mesh covers; below the graph is inside.
#pragma once

#include <cstddef>

#include "harness/surface/surface.h"

namespace touchstone::synthetic {

struct Tessellation {
  surface::TriangleMesh mesh;
  // No point of the mesh is further than this from the analytic surface (rounding aside); 0: the mesh is the surface.
  double deviation_bound_m = 0.0;
};

class AnalyticSurface : public surface::Surface {
 public:
  // A mesh with about `triangles` triangles (the nearest that the shape's topology allows), without T-junctions.
  [[nodiscard]] virtual Tessellation tessellate(std::size_t triangles) const = 0;
  // True: closed and outward oriented; false: an open patch.
  [[nodiscard]] virtual bool closed() const noexcept = 0;
};

// What Surface::closest returns for the foot point q of p: on a smooth part, or on an edge or at a vertex of a sharp
// shape.
inline surface::SurfacePoint analytic_point(const Vec3& q_W_m, const Vec3& n_W, double signed_distance_m,
                                            surface::Feature feature = surface::Feature::analytic) {
  return {q_W_m, n_W, signed_distance_m < 0.0 ? -signed_distance_m : signed_distance_m, signed_distance_m, -1, feature};
}

// The normal at a foot point that was searched for: the surface's there, or beyond the radius of curvature, where a
// rounding of the foot turns the surface's normal more than it turns the line to p, the direction of that line.
inline Vec3 searched_normal(const Vec3& p_W_m, const Vec3& q_W_m, const Vec3& surface_n_W, double signed_distance_m,
                            double curvature_per_m) {
  const double size = signed_distance_m < 0.0 ? -signed_distance_m : signed_distance_m;
  return size * curvature_per_m > 1.0 ? Vec3((p_W_m - q_W_m) / signed_distance_m) : surface_n_W;
}

}  // namespace touchstone::synthetic
