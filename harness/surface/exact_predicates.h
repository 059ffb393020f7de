// On which side of a plane a point lies, decided exactly: a floating-point filter first, then exact expansions.
// Source: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete
// & Computational Geometry 18, 1997: the filter's error bound (section 4.3) and expansion arithmetic (section 2). Exact
// unless a product of three coordinates falls below 1e-290 or above 1e300.
#pragma once

#include <cmath>
#include <limits>

#include "harness/base/vec.h"

namespace touchstone::surface {

// The sign (-1, 0, 1) of ((b - a) x (c - a)) . (d - a): +1 where d lies on the side from which a, b, c run
// counter-clockwise, 0 where the four points lie in one plane.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// The filter over any scalar (harness/base/counted.h): 0 where it cannot decide, else the sign and true.
template <class S>
struct FilteredSide {
  int sign;
  bool certain;
};
template <class S>
FilteredSide<S> filter_side_of_plane(const Vec3Of<S>& a, const Vec3Of<S>& b, const Vec3Of<S>& c, const Vec3Of<S>& d) {
  using std::abs;
  const Vec3Of<S> u = a - d;
  const Vec3Of<S> v = b - d;
  const Vec3Of<S> w = c - d;
  const S vw = v.x() * w.y();
  const S wv = w.x() * v.y();
  const S wu = w.x() * u.y();
  const S uw = u.x() * w.y();
  const S uv = u.x() * v.y();
  const S vu = v.x() * u.y();
  // det(a - d, b - d, c - d) = -det(b - a, c - a, d - a)
  const S det = u.z() * (vw - wv) + v.z() * (wu - uw) + w.z() * (uv - vu);
  const S permanent =
      abs(u.z()) * (abs(vw) + abs(wv)) + abs(v.z()) * (abs(wu) + abs(uw)) + abs(w.z()) * (abs(uv) + abs(vu));
  constexpr double unit_of_rounding = 0.5 * std::numeric_limits<double>::epsilon();
  const S bound = S((7.0 + 56.0 * unit_of_rounding) * unit_of_rounding) * permanent;
  if (det > bound) return {-1, true};
  if (-det > bound) return {1, true};
  return {0, false};
}

// The filter for many points d over one plane, with the plane's a as the origin of the differences in the place of d:
// the same number of roundings in the same places, so the same bound. 0 where it cannot decide.
class PlaneFilter {
 public:
  PlaneFilter(const Vec3& a, const Vec3& b, const Vec3& c) : origin_(a) {
    const Vec3 u = b - a;
    const Vec3 v = c - a;
    const Vec3 first(u.y() * v.z(), u.z() * v.x(), u.x() * v.y());
    const Vec3 second(u.z() * v.y(), u.x() * v.z(), u.y() * v.x());
    normal_ = first - second;
    sizes_ = first.cwiseAbs() + second.cwiseAbs();
  }
  [[nodiscard]] int side(const Vec3& d) const {
    constexpr double unit_of_rounding = 0.5 * std::numeric_limits<double>::epsilon();
    const Vec3 w = d - origin_;
    const double det = dot(normal_, w);
    const double bound = (7.0 + 56.0 * unit_of_rounding) * unit_of_rounding * dot(sizes_, w.cwiseAbs());
    return det > bound ? 1 : -det > bound ? -1 : 0;
  }

 private:
  Vec3 origin_;
  Vec3 normal_;  // not of unit length
  Vec3 sizes_;   // what its differences are made of
};

// The same sign from exact arithmetic alone, for checking the filter.
int side_of_plane_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// side_of_plane() over any scalar; what the filter cannot decide is decided in double, and not counted.
template <class S>
int side_of_plane_of(const Vec3Of<S>& a, const Vec3Of<S>& b, const Vec3Of<S>& c, const Vec3Of<S>& d) {
  const FilteredSide<S> side = filter_side_of_plane<S>(a, b, c, d);
  if (side.certain) return side.sign;
  const auto plain = [](const Vec3Of<S>& x) -> Vec3 { return x.template cast<double>(); };
  return side_of_plane_exact(plain(a), plain(b), plain(c), plain(d));
}

}  // namespace touchstone::surface
