// The point nearest to p where up to a few dozen half-spaces n_i . x >= b_i meet.
//
// An LP-type problem of dimension three (Sharir and Welzl 1992): the answer is determined by at most three of the
// half-spaces, its basis. Each round takes the half-space that the present answer violates most and finds the new basis
// among the old one and it; the distance to p grows with every round, so no basis comes twice.
// For a basis the answer is that of Zilles and Salisbury 1995, section 4: x = p + sum l_i n_i with l from the normal
// equations (n_i . n_j) l = b_i - n_i . p, all l_i >= 0.
// Templates over the scalar, so that operations can be counted (harness/base/counted.h).
#pragma once

#include <array>
#include <span>

#include "harness/base/vec.h"

namespace touchstone::renderers {

template <class S>
struct HalfSpaceOf {
  Vec3Of<S> n;   // unit, into the allowed side
  S b = S(0.0);  // n . x >= b
};
using HalfSpace = HalfSpaceOf<double>;

template <class S>
struct NearestInPolyhedronOf {
  Vec3Of<S> x = Vec3Of<S>::Zero();
  std::array<std::int32_t, 3> basis{-1, -1, -1};  // indices of the half-spaces that hold it, -1 for none
  int basis_size = 0;
  bool found = false;  // false: empty, or too degenerate to decide in double precision
};
using NearestInPolyhedron = NearestInPolyhedronOf<double>;

// `rounding`: how much of a violation counts as none, in the unit of x.
template <class S>
NearestInPolyhedronOf<S> nearest_in_polyhedron_of(std::span<const HalfSpaceOf<S>> half_spaces, const Vec3Of<S>& p,
                                                  const S& rounding) noexcept;
inline NearestInPolyhedron nearest_in_polyhedron(std::span<const HalfSpace> half_spaces, const Vec3& p,
                                                 double rounding) noexcept {
  return nearest_in_polyhedron_of<double>(half_spaces, p, rounding);
}

// The point nearest to p on all of up to three planes n_i . x = b_i. False where they have no common point that double
// precision could tell, or where one of them pulls (l_i < 0).
template <class S>
bool nearest_on_planes(std::span<const HalfSpaceOf<S>> planes, const Vec3Of<S>& p, Vec3Of<S>& x) noexcept;

}  // namespace touchstone::renderers
