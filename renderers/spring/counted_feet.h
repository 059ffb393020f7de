// The closest point of a mesh with every operation counted: what SurfaceFeet (closest_spring.h) asks Embree, found on
// a plain tree of boxes (harness/surface/box_tree.h). The same answer to the bit as make_embree_surface()'s.
//
// Counted: the tree's box distances, the triangles' closest points, the sign and the pseudo-normal of an edge.
#pragma once

#include <memory>
#include <vector>

#include "harness/base/counted.h"
#include "harness/surface/box_tree.h"
#include "harness/surface/mesh_topology.h"
#include "renderers/spring/closest_spring.h"

namespace touchstone::renderers {

class CountedFeet {
 public:
  using Scalar = Counted;
  // Throws BadData for a surface without triangles: an analytic shape's own arithmetic is not counted.
  explicit CountedFeet(const surface::Surface& surface);
  [[nodiscard]] Foot<Counted> closest(const Vec3Of<Counted>& p_W_m) const;

 private:
  struct Facet {
    std::array<Vec3Of<Counted>, 3> corners;
    Vec3Of<Counted> normal;
  };
  [[nodiscard]] Vec3Of<Counted> normal_at(std::size_t triangle, surface::Feature feature, std::size_t index) const;

  std::shared_ptr<const surface::TriangleMesh> mesh_;
  surface::MeshTopology topology_;
  std::vector<Facet> facets_;
  surface::BoxTree tree_;
};

}  // namespace touchstone::renderers
