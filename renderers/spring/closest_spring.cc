#include "renderers/spring/closest_spring.h"

#include <array>

#include "harness/surface/triangle_queries.h"

namespace touchstone::renderers {
using surface::Feature;

bool on_rim(const surface::MeshTopology& topology, const surface::TriangleMesh& mesh, std::size_t triangle,
            Feature feature, std::size_t index) noexcept {
  if (feature == Feature::edge) return topology.neighbours[triangle][index] == surface::open_edge;
  if (feature != Feature::vertex) return false;
  const auto corner = static_cast<std::size_t>(mesh.triangles[triangle][index]);
  return (topology.vertex_flags[corner] & surface::vertex_open) != 0;
}

bool on_rim(const surface::Surface& surface, const surface::SurfacePoint& point, const Vec3& p_W_m) noexcept {
  if (surface.topology() == nullptr || point.triangle < 0) return false;
  const surface::TriangleMesh& mesh = *surface.mesh();
  const auto t = static_cast<std::size_t>(point.triangle);
  std::array<Vec3, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh.vertices_W_m[static_cast<std::size_t>(mesh.triangles[t][i])];
  // The surface's answer does not say which edge or corner of the triangle it is.
  const surface::TriangleClosest where =
      surface::closest_on_triangle(corners, surface.topology()->face_normals[t], p_W_m);
  return on_rim(*surface.topology(), mesh, t, where.feature, where.index);
}

}  // namespace touchstone::renderers
