// On which side of a plane a point lies, decided exactly: a floating-point filter first, then exact expansions.
// Source: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete
// & Computational Geometry 18, 1997: the filter's error bound (section 4.3) and expansion arithmetic (section 2). Exact
// unless a product of three coordinates falls below 1e-290 or above 1e300.
#pragma once

#include "harness/base/vec.h"

namespace touchstone {

// The sign (-1, 0, 1) of ((b - a) x (c - a)) . (d - a): +1 where d lies on the side from which a, b, c run
// counter-clockwise, 0 where the four points lie in one plane.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// The same sign from exact arithmetic alone, for checking the filter.
int side_of_plane_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace touchstone
