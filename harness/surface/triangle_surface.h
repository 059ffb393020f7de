// What surfaces over triangles share, whichever structure finds the triangles: the mesh, its normals, and how a found
// triangle becomes an answer.
#pragma once

#include "harness/surface/mesh_topology.h"
#include "harness/surface/surface.h"
#include "harness/surface/triangle_queries.h"

namespace touchstone {

class TriangleSurface : public Surface {
 public:
  // Joins vertices with equal coordinates. Throws BadData for no triangles or an index out of range.
  explicit TriangleSurface(const TriangleMesh& mesh);

  [[nodiscard]] Box3 bounds() const override { return bounds_; }
  [[nodiscard]] const TriangleMesh* mesh() const noexcept override { return &mesh_; }
  [[nodiscard]] const MeshTopology& topology() const noexcept { return topology_; }

 protected:
  [[nodiscard]] std::array<Vec3, 3> corners(std::int32_t triangle) const {
    const auto& [a, b, c] = mesh_.triangles[static_cast<std::size_t>(triangle)];
    return {mesh_.vertices_W_m[static_cast<std::size_t>(a)], mesh_.vertices_W_m[static_cast<std::size_t>(b)],
            mesh_.vertices_W_m[static_cast<std::size_t>(c)]};
  }
  [[nodiscard]] const Vec3& face_normal(std::int32_t triangle) const {
    return topology_.face_normals[static_cast<std::size_t>(triangle)];
  }
  [[nodiscard]] SurfacePoint finish(const Vec3& q, std::int32_t triangle, const TriangleClosest& closest) const;
  [[nodiscard]] Crossing finish(const Vec3& a, const Vec3& b, std::int32_t triangle,
                                const TriangleCrossing& crossing) const;
  // For a query point that is not finite.
  [[nodiscard]] static SurfacePoint no_point(const Vec3& q);

  TriangleMesh mesh_;
  MeshTopology topology_;
  Box3 bounds_;  // of the triangles; vertices that no triangle uses do not count
};

}  // namespace touchstone
