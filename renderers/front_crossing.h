// The first triangle that a moving point meets from its front side.
//
// Whether the path passes through a triangle's outline is decided exactly (exact_predicates.h), so that nothing slips
// between triangles. Whether it starts in front is not: a point that was left on the surface by the last step lies on
// it to rounding only, so a start behind the plane by no more than rounding counts as in front.
#pragma once

#include <algorithm>
#include <limits>

#include "harness/surface/exact_predicates.h"
#include "renderers/contact_mesh.h"

namespace touchstone {

struct FrontCrossing {
  std::int32_t triangle = -1;
  double fraction = 1.0;  // of the way
};

// How far behind a plane a point on the surface can come to lie by rounding. A foot on a plane, p + push, is off by
// half a unit in the last place of each coordinate of p, of the push and of the sum; evaluating its height over another
// plane rounds three differences and five sums and products. With |x| the largest coordinate: below 3 (1 + 1 + 6) eps/2
// |x| = 12 eps |x|; the normal itself is off by up to eps times the ratio of the triangle's edge to its height.
inline double resting_error(const ContactMesh& mesh, const Vec3& a) noexcept {
  return 16.0 * std::numeric_limits<double>::epsilon() * std::max(mesh.magnitude(), a.cwiseAbs().maxCoeff());
}

// Whether the way from a to p passes through the triangle's outline where it crosses its plane, exactly.
inline bool through_outline(const ContactMesh& mesh, const Facet& facet, const Vec3& a, const Vec3& p) noexcept {
  for (std::size_t e = 0; e < 3; ++e) {
    // Seen against the normal the outline runs counter-clockwise: the way keeps every edge on the same side.
    if (side_of_plane(a, p, mesh.vertex(facet.corner[e]), mesh.vertex(facet.corner[(e + 1) % 3])) > 0) return false;
  }
  return true;
}

inline bool within(const Facet& facet, const Vec3& x, double widen) noexcept {
  return facet.inside(0, x) >= -widen && facet.inside(1, x) >= -widen && facet.inside(2, x) >= -widen;
}

// A way that leaves the surface almost along it: having started on a triangle that is skipped, it can come over the
// border of the next one already behind that one's plane, by rounding. The fraction at which it does; 2 where it does
// not.
inline double slips_under(const Facet& facet, const Vec3& a, const Vec3& p, double from, double to,
                          double rounding) noexcept {
  double enters = 0.0;
  double leaves = 1.0;
  for (std::size_t e = 0; e < 3; ++e) {
    const double first = facet.inside(e, a);
    const double last = facet.inside(e, p);
    if (first < 0.0) {
      if (last <= 0.0) return 2.0;
      enters = std::max(enters, first / (first - last));
    } else if (last < 0.0) {
      leaves = std::min(leaves, first / (first - last));
    }
  }
  const double at_border = from + enters * (to - from);
  return enters < leaves && std::abs(at_border) <= rounding && from + leaves * (to - from) < 0.0 ? enters : 2.0;
}

// Triangles for which skip(triangle) holds are passed. Ties go to the smaller index. Outlines are taken wider by
// `widen`: where neighbours are not known a crossing at a border must not fall between two triangles.
template <class Skip>
FrontCrossing first_front_crossing(const ContactMesh& mesh, const Vec3& a, const Vec3& p, Skip&& skip,
                                   double widen = 0.0) noexcept {
  FrontCrossing first;
  const double rounding = resting_error(mesh, a);
  mesh.tree().along_segment(a, p, [&](std::int32_t t) {
    const Facet& facet = mesh.facet(t);
    const double from = facet.height(a);
    const double to = facet.height(p);
    if (!(to < 0.0 && from >= -rounding && from > to) || skip(t)) return first.fraction;
    double fraction = std::max(0.0, from / (from - to));
    if (!through_outline(mesh, facet, a, p) && !(widen > 0.0 && within(facet, a + fraction * (p - a), widen))) {
      fraction = slips_under(facet, a, p, from, to, rounding);
    }
    if (fraction < first.fraction || (fraction == first.fraction && (first.triangle < 0 || t < first.triangle)))
      first = {t, fraction};
    return first.fraction;
  });
  return first;
}

}  // namespace touchstone
