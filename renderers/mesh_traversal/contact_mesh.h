// A triangle mesh as a renderer that walks on it wants it: one record per triangle with everything that a step on it
// reads, neighbours by index, and the tree for the rest. Shared between renderers on the same surface.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "harness/surface/mesh_topology.h"
#include "harness/surface/surface.h"
#include "harness/surface/triangle_tree.h"
#include "renderers/mesh_traversal/flush.h"

namespace touchstone::renderers {

// A triangle's plane and borders. Edge e runs from corner e to corner (e + 1) mod 3.
template <class S>
struct FacetOf {
  Vec3Of<S> origin;                         // corner 0
  Vec3Of<S> n;                              // outward unit normal; zero where the triangle has no area
  std::array<Vec3Of<S>, 3> inward;          // unit, in the plane, from edge e towards the triangle's inside
  S inset{};                                // of edge 1 from the origin along inward[1]; edges 0 and 2 pass through it
  std::array<std::int32_t, 3> corner{};     // vertex indices
  std::array<std::int32_t, 3> neighbour{};  // across edge e: a triangle, open_edge or non_manifold_edge
  std::array<bool, 3> valley{};             // edge e is concave seen from outside
  bool regular = false;                     // may be walked on by its neighbours (mesh_regularity.h)

  // Signed distance from the plane, positive outside.
  [[nodiscard]] S height(const Vec3Of<S>& x) const noexcept { return dot(n, x - origin); }
  // Signed distance within the plane from edge e's line, positive on the triangle's side.
  [[nodiscard]] S inside(std::size_t e, const Vec3Of<S>& x) const noexcept {
    const S along = dot(inward[e], x - origin);
    return e == 1 ? along - inset : along;
  }
};
using Facet = FacetOf<double>;

class ContactMesh {
 public:
  using Scalar = double;
  // Throws BadData for a surface without triangles. The surface must outlive this.
  explicit ContactMesh(const surface::Surface& surface);

  [[nodiscard]] const Facet& facet(std::int32_t triangle) const noexcept {
    return facets_[static_cast<std::size_t>(triangle)];
  }
  [[nodiscard]] const Vec3& vertex(std::int32_t index) const noexcept {
    return mesh_->vertices_W_m[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] const Vec3& vertex_normal(std::int32_t index) const noexcept {
    return topology_->vertex_normals[static_cast<std::size_t>(index)];
  }
  // Whether the vertex, or the edge or corner with that index of the triangle, is on the rim of an open mesh.
  [[nodiscard]] bool open_vertex(std::int32_t index) const noexcept {
    return (topology_->vertex_flags[static_cast<std::size_t>(index)] & surface::vertex_open) != 0;
  }
  [[nodiscard]] bool on_rim(std::int32_t triangle, surface::Feature feature, std::size_t local) const noexcept {
    if (feature == surface::Feature::edge) return facet(triangle).neighbour[local] < 0;
    return feature == surface::Feature::vertex && open_vertex(facet(triangle).corner[local]);
  }
  [[nodiscard]] std::span<const std::int32_t> fan(std::int32_t vertex) const {
    return topology_->fan(static_cast<std::size_t>(vertex));
  }
  [[nodiscard]] std::array<Vec3, 3> corners(std::int32_t triangle) const {
    const auto& c = facet(triangle).corner;
    return {vertex(c[0]), vertex(c[1]), vertex(c[2])};
  }
  // The local index of the edge of `triangle` that borders `neighbour`.
  [[nodiscard]] std::size_t edge_towards(std::int32_t triangle, std::int32_t neighbour,
                                         std::int32_t from) const noexcept;
  [[nodiscard]] const surface::TriangleTree& tree() const noexcept { return *tree_; }
  [[nodiscard]] std::size_t triangle_count() const noexcept { return facets_.size(); }
  [[nodiscard]] std::size_t vertex_count() const noexcept { return mesh_->vertices_W_m.size(); }
  // All triangles may be walked on.
  [[nodiscard]] bool regular() const noexcept {
    return std::all_of(facets_.begin(), facets_.end(), [](const Facet& facet) { return facet.regular; });
  }
  // Without the mesh itself and the tree, which is Embree's.
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return facets_.capacity() * sizeof(Facet) + topology_->memory_bytes();
  }
  [[nodiscard]] bool closed() const noexcept { return topology_->closed(); }
  // Some edge has one triangle only: the mesh has a rim, beyond which inside and outside are not defined.
  [[nodiscard]] bool open() const noexcept { return topology_->open_edge_count > 0; }
  // The length of the bounding box's diagonal.
  [[nodiscard]] double extent() const noexcept { return extent_; }
  // The largest magnitude of a coordinate: what rounding of positions on the surface is relative to.
  [[nodiscard]] double magnitude() const noexcept { return magnitude_; }
  // Of a triangle.
  [[nodiscard]] double mean_area() const noexcept { return mean_area_; }
  // Steps and gaps up to it count as none where bodies meet.
  [[nodiscard]] double flush() const noexcept { return flush_m(magnitude_); }

 private:
  void make_facets();

  const surface::TriangleMesh* mesh_;
  std::unique_ptr<const surface::MeshTopology> own_topology_;  // null where the surface has them
  std::unique_ptr<const surface::TriangleTree> own_tree_;
  const surface::MeshTopology* topology_;
  const surface::TriangleTree* tree_;
  std::vector<Facet> facets_;
  double magnitude_ = 0.0;
  double extent_ = 0.0;
  double mean_area_ = 0.0;
};

// One ContactMesh per surface, however many renderers run on it at the same time.
std::shared_ptr<const ContactMesh> contact_mesh(const std::shared_ptr<const surface::Surface>& surface);

}  // namespace touchstone::renderers
