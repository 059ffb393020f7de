// The first triangle that a moving point meets from its front side.
//
// Whether the path passes through a triangle's outline is decided exactly (exact_predicates.h), so that nothing slips
// between triangles. Whether it starts in front is not: a point that was left on the surface by the last step lies on
// it to rounding only, so a start behind the plane by no more than rounding counts as in front.
#pragma once

#include <algorithm>
#include <limits>

#include "harness/surface/exact_predicates.h"
#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::renderers {

template <class S>
struct FrontCrossingOf {
  std::int32_t triangle = -1;
  S fraction = S(1.0);  // of the way
};
using FrontCrossing = FrontCrossingOf<double>;

// How far behind a plane a point on the surface can come to lie by rounding. A foot on a plane, p + push, is off by
// half a unit in the last place of each coordinate of p, of the push and of the sum; evaluating its height over another
// plane rounds three differences and five sums and products. With |x| the largest coordinate: below 3 (1 + 1 + 6) eps/2
// |x| = 12 eps |x|; the normal itself is off by up to eps times the ratio of the triangle's edge to its height.
template <class Mesh>
typename Mesh::Scalar resting_error(const Mesh& mesh, const Vec3Of<typename Mesh::Scalar>& a) noexcept {
  using S = typename Mesh::Scalar;
  using std::abs;
  const S largest = std::max(std::max(abs(a.x()), abs(a.y())), abs(a.z()));
  return S(16.0 * std::numeric_limits<double>::epsilon()) * std::max(S(mesh.magnitude()), largest);
}

// Whether the way from a to p passes through the triangle's outline where it crosses its plane, exactly.
template <class Mesh, class S = typename Mesh::Scalar>
bool through_outline(const Mesh& mesh, const FacetOf<S>& facet, const Vec3Of<S>& a, const Vec3Of<S>& p) noexcept {
  for (std::size_t e = 0; e < 3; ++e) {
    // Seen against the normal the outline runs counter-clockwise: the way keeps every edge on the same side.
    if (surface::side_of_plane_of<S>(a, p, mesh.vertex(facet.corner[e]), mesh.vertex(facet.corner[(e + 1) % 3])) > 0)
      return false;
  }
  return true;
}

template <class S>
bool within(const FacetOf<S>& facet, const Vec3Of<S>& x, const S& widen) noexcept {
  return facet.inside(0, x) >= -widen && facet.inside(1, x) >= -widen && facet.inside(2, x) >= -widen;
}

// A way that leaves the surface almost along it: having started on a triangle that is skipped, it can come over the
// border of the next one already behind that one's plane, by rounding. The fraction at which it does; 2 where it does
// not.
template <class S>
S slips_under(const FacetOf<S>& facet, const Vec3Of<S>& a, const Vec3Of<S>& p, const S& from, const S& to,
              const S& rounding) noexcept {
  using std::abs;
  const S none(0.0);
  S enters(0.0);
  S leaves(1.0);
  for (std::size_t e = 0; e < 3; ++e) {
    const S first = facet.inside(e, a);
    const S last = facet.inside(e, p);
    if (first < none) {
      if (last <= none) return S(2.0);
      enters = std::max(enters, S(first / (first - last)));
    } else if (last < none) {
      leaves = std::min(leaves, S(first / (first - last)));
    }
  }
  const S at_border = from + enters * (to - from);
  return enters < leaves && abs(at_border) <= rounding && from + leaves * (to - from) < none ? enters : S(2.0);
}

// Triangles for which skip(triangle) holds are passed. Ties go to the smaller index. Outlines are taken wider by
// `widen`: where neighbours are not known a crossing at a border must not fall between two triangles.
template <class Mesh, class Skip, class S = typename Mesh::Scalar>
FrontCrossingOf<S> first_front_crossing(const Mesh& mesh, const Vec3Of<S>& a, const Vec3Of<S>& p, Skip&& skip,
                                        double widen = 0.0) noexcept {
  FrontCrossingOf<S> first;
  const S none(0.0);
  const S rounding = resting_error(mesh, a);
  mesh.tree().along_segment(a, p, [&](std::int32_t t) {
    const FacetOf<S>& facet = mesh.facet(t);
    const S from = facet.height(a);
    const S to = facet.height(p);
    if (!(to < none && from >= -rounding && from > to) || skip(t)) return first.fraction;
    S fraction = std::max(none, S(from / (from - to)));
    if (!through_outline(mesh, facet, a, p) &&
        !(widen > 0.0 && within(facet, Vec3Of<S>(a + fraction * (p - a)), S(widen)))) {
      fraction = slips_under(facet, a, p, from, to, rounding);
    }
    if (fraction < first.fraction || (fraction == first.fraction && (first.triangle < 0 || t < first.triangle)))
      first = {t, fraction};
    return first.fraction;
  });
  return first;
}

}  // namespace touchstone::renderers
