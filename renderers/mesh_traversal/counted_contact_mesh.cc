#include "renderers/mesh_traversal/counted_contact_mesh.h"

namespace touchstone::renderers {

CountedContactMesh::CountedContactMesh(std::shared_ptr<const ContactMesh> mesh, const surface::TriangleMesh& triangles)
    : mesh_(std::move(mesh)), tree_(triangles) {
  for (std::size_t t = 0; t < mesh_->triangle_count(); ++t) {
    const Facet& plain = mesh_->facet(static_cast<std::int32_t>(t));
    FacetOf<Counted> facet;
    facet.origin = plain.origin.cast<Counted>();
    facet.n = plain.n.cast<Counted>();
    for (std::size_t e = 0; e < 3; ++e) facet.inward[e] = plain.inward[e].cast<Counted>();
    facet.inset = plain.inset;
    facet.corner = plain.corner;
    facet.neighbour = plain.neighbour;
    facet.valley = plain.valley;
    facet.regular = plain.regular;
    facets_.push_back(facet);
  }
  for (std::size_t v = 0; v < mesh_->vertex_count(); ++v) {
    const auto index = static_cast<std::int32_t>(v);
    vertices_.push_back(mesh_->vertex(index).cast<Counted>());
    vertex_normals_.push_back(mesh_->vertex_normal(index).cast<Counted>());
  }
}

}  // namespace touchstone::renderers
