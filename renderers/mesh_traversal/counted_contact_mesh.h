// A ContactMesh whose numbers count what is done with them (harness/base/counted.h), with a plain tree of boxes in the
// place of Embree's, so that every operation of a step on it is counted. See surface_walk.h.
#pragma once

#include <memory>
#include <vector>

#include "harness/base/counted.h"
#include "harness/surface/box_tree.h"
#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::renderers {

class CountedContactMesh {
 public:
  using Scalar = Counted;
  // `triangles`: those of `mesh`.
  CountedContactMesh(std::shared_ptr<const ContactMesh> mesh, const surface::TriangleMesh& triangles);

  [[nodiscard]] const FacetOf<Counted>& facet(std::int32_t triangle) const noexcept {
    return facets_[static_cast<std::size_t>(triangle)];
  }
  [[nodiscard]] const Vec3Of<Counted>& vertex(std::int32_t index) const noexcept {
    return vertices_[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] const Vec3Of<Counted>& vertex_normal(std::int32_t index) const noexcept {
    return vertex_normals_[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] std::array<Vec3Of<Counted>, 3> corners(std::int32_t triangle) const {
    const auto& c = facet(triangle).corner;
    return {vertex(c[0]), vertex(c[1]), vertex(c[2])};
  }
  [[nodiscard]] const surface::BoxTree& tree() const noexcept { return tree_; }
  [[nodiscard]] bool open_vertex(std::int32_t index) const noexcept { return mesh_->open_vertex(index); }
  [[nodiscard]] std::span<const std::int32_t> fan(std::int32_t vertex) const { return mesh_->fan(vertex); }
  [[nodiscard]] std::size_t edge_towards(std::int32_t triangle, std::int32_t neighbour,
                                         std::int32_t from) const noexcept {
    return mesh_->edge_towards(triangle, neighbour, from);
  }
  [[nodiscard]] bool closed() const noexcept { return mesh_->closed(); }
  [[nodiscard]] bool on_rim(std::int32_t triangle, surface::Feature feature, std::size_t local) const noexcept {
    return mesh_->on_rim(triangle, feature, local);
  }
  [[nodiscard]] double extent() const noexcept { return mesh_->extent(); }
  [[nodiscard]] double magnitude() const noexcept { return mesh_->magnitude(); }
  [[nodiscard]] const ContactMesh& plain() const noexcept { return *mesh_; }

 private:
  std::shared_ptr<const ContactMesh> mesh_;
  std::vector<FacetOf<Counted>> facets_;
  std::vector<Vec3Of<Counted>> vertices_;
  std::vector<Vec3Of<Counted>> vertex_normals_;
  surface::BoxTree tree_;
};

}  // namespace touchstone::renderers
