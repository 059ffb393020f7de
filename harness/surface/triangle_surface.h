// What surfaces over triangles share, whichever structure finds the triangles: the mesh, its normals, and how a found
// triangle becomes an answer.
#pragma once

#include <functional>

#include "harness/surface/mesh_topology.h"
#include "harness/surface/surface.h"
#include "harness/surface/triangle_queries.h"

namespace touchstone::surface {

class TriangleSurface : public Surface {
 public:
  // Joins vertices with equal coordinates. Throws BadData for no triangles or an index out of range. `beside` is called
  // with the surface's own mesh() while its topology is made, on another thread where there is one.
  explicit TriangleSurface(const TriangleMesh& mesh, const std::function<void(const TriangleMesh&)>& beside = {});

  [[nodiscard]] Box3 bounds() const override { return bounds_; }
  [[nodiscard]] const TriangleMesh* mesh() const noexcept override { return &mesh_; }
  [[nodiscard]] const MeshTopology* topology() const noexcept override { return &topology_; }

 protected:
  // Corners and unit normal (zero without area) side by side: a query that visits a triangle waits for one place in
  // memory, not for six.
  struct Facet {
    std::array<Vec3, 3> corners;
    Vec3 normal;
  };
  [[nodiscard]] const Facet& facet(std::int32_t triangle) const { return facets_[static_cast<std::size_t>(triangle)]; }
  [[nodiscard]] SurfacePoint finish(const Vec3& q, std::int32_t triangle, const TriangleClosest& closest) const;
  [[nodiscard]] Crossing finish(const Vec3& a, const Vec3& b, std::int32_t triangle,
                                const TriangleCrossing& crossing) const;
  // For a query point that is not finite.
  [[nodiscard]] static SurfacePoint no_point(const Vec3& q);

 private:
  void make_facets();

 protected:
  TriangleMesh mesh_;
  MeshTopology topology_;
  std::vector<Facet> facets_;
  Box3 bounds_;  // of the triangles; vertices that no triangle uses do not count
};

}  // namespace touchstone::surface
