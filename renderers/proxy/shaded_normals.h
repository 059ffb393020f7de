// Normals that change smoothly over a mesh, as Gouraud's and Phong's for pictures: at a corner the mean of the normals
// of the triangles about it, weighted by their angles there (Baerentzen and Aanaes 2005, equation 3); over a triangle
// interpolated linearly in barycentric coordinates.
//
// Edges whose faces' normals differ by the crease angle or more stay sharp: a corner takes the mean only over triangles
// that are joined to its own through other edges, and on a sharp edge, or at a corner where several means meet, there
// is no normal. Along the rim of an open mesh the mean is over the one side that there is. Triangles without area have
// no part in it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "renderers/friction/contact_places.h"
#include "renderers/mesh_traversal/contact_mesh.h"
#include "renderers/mesh_traversal/fetch.h"

namespace touchstone::renderers {

class ShadedNormals {
 public:
  // crease_angle_rad: 0 leaves every edge sharp, pi none.
  ShadedNormals(const ContactMesh& mesh, double crease_angle_rad);

  // The direction m of the interpolated normal at a place with the normal n, m not of unit length. Answers n . m, or
  // zero where n stays: where the feature is sharp or m would turn the force by a right angle or more.
  // `facet` is the place's triangle. A template, so that the operations can be counted (harness/base/counted.h).
  template <class S, class Place>
  [[nodiscard]] S direction(const FacetOf<S>& facet, const Place& place, const Vec3Of<S>& n,
                            Vec3Of<S>& m) const noexcept {
    const Shade& shade = shades_[static_cast<std::size_t>(place.triangle)];
    if (place.feature == surface::Feature::edge && !shade.smooth_edge[place.index]) return S(0.0);
    if (place.feature == surface::Feature::vertex && !shade.smooth_corner[place.index]) return S(0.0);
    const Vec3Of<S> r = place.p - facet.origin;
    m = shade.n0.cast<S>() + dot(facet.inward[2], r) * shade.d1.cast<S>() +
        dot(facet.inward[0], r) * shade.d2.cast<S>();
    return std::max(S(0.0), dot(n, m));
  }
  // The interpolated unit normal, or the contact's own.
  template <class S>
  [[nodiscard]] Vec3Of<S> at(const FacetOf<S>& facet, const typename ContactPlacesOf<S>::Place& place) const noexcept {
    Vec3Of<S> m;
    return direction<S>(facet, place, place.n, m) > S(0.0) ? unit(m) : place.n;
  }
  // Has what is stored of a triangle's neighbours fetched from memory: the next contact is most likely on one of them.
  void fetch_about(const std::array<std::int32_t, 3>& neighbours) const noexcept {
    for (const std::int32_t t : neighbours) {
      if (t >= 0) fetch(shades_[static_cast<std::size_t>(t)]);
    }
  }

 private:
  // n(x) ~ n0 + d1 (inward[2] . (x - corner 0)) + d2 (inward[0] . (x - corner 0)): corner 1 lies opposite of edge 2.
  struct Shade {
    Vec3 n0, d1, d2;
    std::array<bool, 3> smooth_edge{};
    std::array<bool, 3> smooth_corner{};
  };
  std::vector<Shade> shades_;
};

}  // namespace touchstone::renderers
