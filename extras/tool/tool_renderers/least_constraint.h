// Gauss' principle of least constraint for one rigid body: of all displacements that respect the contacts, the one
// nearest to the free displacement u in the metric of the mass matrix. With coordinates in which the metric is the unit
// matrix it is the point nearest to u in a polyhedron of R^6:
//   min |y - u|^2 / 2   subject to   a_i . y >= b_i,      y = u + sum l_i a_i,  l_i >= 0.
// Ortega, Redon and Coquillart 2007, section 4 (they solve it by Wilhelmsen's projection); here by the dual active-set
// method of Goldfarb and Idnani (1983), which stops after finitely many exchanges and needs no feasible start.
// Allocates nothing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "tool_renderers/sphere_tree.h"

namespace touchstone::tool_renderers {

using Vec6 = Eigen::Matrix<double, 6, 1>;

struct HalfSpace6 {
  Vec6 a = Vec6::Zero();
  double b = 0.0;  // a . y >= b
};

struct LeastConstraint {
  bool found = false;  // false: no such point, or too degenerate for double precision
  Vec6 y = Vec6::Zero();
  int active_count = 0;
  std::array<int, 6> active{};         // indices of the half-spaces that hold y
  std::array<double, 6> multiplier{};  // l_i of each, > 0
};

// `rounding`: how much of a violation counts as none, in the unit of b.
LeastConstraint least_constraint(std::span<const HalfSpace6> half_spaces, const Vec6& u, double rounding) noexcept;

}  // namespace touchstone::tool_renderers
