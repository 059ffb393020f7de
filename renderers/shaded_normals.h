// Normals that change smoothly over a mesh, as Gouraud's and Phong's for pictures: at a corner the mean of the normals
// of the triangles about it, weighted by their angles there (Baerentzen and Aanaes 2005, equation 3); over a triangle
// interpolated linearly in barycentric coordinates.
//
// Edges whose faces' normals differ by the crease angle or more stay sharp: a corner takes the mean only over triangles
// that are joined to its own through other edges, and on a sharp edge, or at a corner where several means meet, there
// is no normal. Along the rim of an open mesh the mean is over the one side that there is. Triangles without area have
// no part in it.
#pragma once

#include <vector>

#include "renderers/contact_mesh.h"
#include "renderers/contact_places.h"

namespace touchstone {

class ShadedNormals {
 public:
  // crease_angle_rad: 0 leaves every edge sharp, pi none.
  ShadedNormals(const ContactMesh& mesh, double crease_angle_rad);

  // The interpolated unit normal; the contact's own where the feature is sharp or the interpolated one would turn the
  // force by a right angle or more.
  // `facet` is the place's triangle. A template, so that the operations can be counted (harness/base/counted.h).
  template <class S>
  [[nodiscard]] Vec3Of<S> at(const FacetOf<S>& facet, const typename ContactPlacesOf<S>::Place& place) const noexcept {
    const Shade& shade = shades_[static_cast<std::size_t>(place.triangle)];
    if (place.feature == Feature::edge && !shade.smooth_edge[place.index]) return place.n;
    if (place.feature == Feature::vertex && !shade.smooth_corner[place.index]) return place.n;
    const Vec3Of<S> r = place.p - facet.origin;
    const Vec3Of<S> n = shade.n0.cast<S>() + dot(facet.inward[2], r) * shade.d1.cast<S>() +
                        dot(facet.inward[0], r) * shade.d2.cast<S>();
    return dot(n, place.n) > S(0.0) ? unit(n) : place.n;
  }

 private:
  // n(x) ~ n0 + d1 (inward[2] . (x - corner 0)) + d2 (inward[0] . (x - corner 0)): corner 1 lies opposite of edge 2.
  struct Shade {
    Vec3 n0, d1, d2;
    std::array<bool, 3> smooth_edge;
    std::array<bool, 3> smooth_corner;
  };
  std::vector<Shade> shades_;
};

}  // namespace touchstone
