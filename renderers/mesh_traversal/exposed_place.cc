#include "renderers/mesh_traversal/exposed_place.h"

#include <algorithm>
#include <limits>

#include "harness/surface/triangle_queries.h"
#include "renderers/mesh_traversal/flush.h"

namespace touchstone::renderers {
using surface::SurfacePoint;

namespace {

// Along no plane, edge or diagonal that a body is likely to have: a ray along one would count borders twice.
const Vec3& awry() {
  static const Vec3 direction = Vec3(0.5377, 0.7391, 0.4057).normalized();
  return direction;
}

template <class Mesh>
StartPlace place_on(const Mesh& mesh, std::int32_t triangle, const Vec3& p) {
  const surface::TriangleClosest where =
      surface::closest_on_triangle(mesh.corners(triangle), mesh.facet(triangle).n, p);
  return {true, triangle, where.feature, where.index, p + where.from_query};
}

// Whether there is free space in front of the triangle at that place.
template <class Mesh>
bool exposed(const Mesh& mesh, std::int32_t triangle, const Vec3& place) noexcept {
  // In front of all that is flush with it.
  const Vec3 front = place + 2.0 * mesh.flush() * mesh.facet(triangle).n;
  return winding_about(mesh, front) <= 0;
}

// By balls that grow until one holds an exposed place: then no closer one is outside of it.
template <class Mesh>
StartPlace closest_exposed(const Mesh& mesh, const Vec3& p, double nearest_m) noexcept {
  StartPlace best;
  for (double radius = 2.0 * std::max(nearest_m, mesh.flush()); best.triangle < 0; radius *= 2.0) {
    double least = radius;
    mesh.tree().within(p, radius, [&](std::int32_t t) {
      if (mesh.facet(t).n.isZero(0.0)) return least;
      const StartPlace place = place_on(mesh, t, p);
      const double away = (place.p_W_m - p).norm();
      const bool closer = away < least || (away == least && (best.triangle < 0 || t < best.triangle));
      if (closer && exposed(mesh, t, place.p_W_m)) {
        least = away;
        best = place;
      }
      return least;
    });
    if (!(radius < 4.0 * (mesh.extent() + nearest_m))) break;
  }
  return best;
}

}  // namespace

template <class Mesh>
int winding_about(const Mesh& mesh, const Vec3& p) noexcept {
  const Vec3 far = p + (2.0 * mesh.extent() + 2.0 * mesh.magnitude() + p.norm()) * awry();
  int winding = 0;
  mesh.tree().along_segment(p, far, [&](std::int32_t t) {
    if (const auto crossing = surface::cross_triangle(mesh.corners(t), mesh.facet(t).n, p, far))
      winding += crossing->entering ? -1 : 1;
    return 1.0;
  });
  return winding;
}
template int winding_about(const ContactMesh&, const Vec3&) noexcept;
template int winding_about(const PosedBodies&, const Vec3&) noexcept;

namespace {

// Whether p is inside of the bodies, of which `triangle`, `away_m` off, is the closest. In a wall between two of them
// a ray's count is noise: there both sides of the wall decide.
template <class Mesh>
bool inside_bodies(const Mesh& mesh, std::int32_t triangle, double away_m, const Vec3& p) noexcept {
  if (winding_about(mesh, p) > 0) return true;
  if (away_m > mesh.flush()) return false;
  const Vec3 aside = 2.0 * mesh.flush() * mesh.facet(triangle).n;
  return winding_about(mesh, p + aside) > 0 && winding_about(mesh, p - aside) > 0;
}

}  // namespace

StartPlace start_place(const ContactMesh& mesh, const surface::Surface& surface, const Vec3& p) noexcept {
  const SurfacePoint nearest = surface.closest(p);
  if (nearest.triangle < 0) return {};
  const bool bodies = !mesh.facet(nearest.triangle).regular && !mesh.open();
  if (bodies) {
    // The sign of the distance is that of one body's surface, be it inside another.
    if (!inside_bodies(mesh, nearest.triangle, nearest.distance_m, p)) return {};
    return closest_exposed(mesh, p, nearest.distance_m);
  }
  if (!(nearest.signed_distance_m < 0.0)) return {};
  const StartPlace place = place_on(mesh, nearest.triangle, p);
  // Beyond the rim of an open mesh there is no inside.
  if (mesh.on_rim(nearest.triangle, place.feature, place.index)) return {};
  return {true, nearest.triangle, place.feature, place.index, nearest.p_W_m};
}

StartPlace start_place(const PosedBodies& bodies, const Vec3& p) noexcept {
  // Of all bodies' closest points the closest.
  const PosedBody* nearest_body = nullptr;
  SurfacePoint nearest;
  nearest.distance_m = std::numeric_limits<double>::infinity();
  for (const PosedBody& body : bodies.bodies()) {
    const SurfacePoint here = body.surface().closest(body.to_B(p));
    if (here.triangle < 0 || !(here.distance_m < nearest.distance_m)) continue;
    nearest = here;
    nearest_body = &body;
  }
  if (nearest_body == nullptr) return {};
  const std::int32_t triangle = nearest.triangle + nearest_body->first_triangle();
  if (!bodies.open()) {
    if (!inside_bodies(bodies, triangle, nearest.distance_m, p)) return {};
    return closest_exposed(bodies, p, nearest.distance_m);
  }
  if (!(nearest.signed_distance_m < 0.0)) return {};
  const StartPlace place = place_on(bodies, triangle, p);
  if (nearest_body->mesh().on_rim(nearest.triangle, place.feature, place.index)) return {};
  return place;
}

}  // namespace touchstone::renderers
