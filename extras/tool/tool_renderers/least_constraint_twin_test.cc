// The solver of the contact constraints against a slow exact twin: CGAL's quadratic programming in exact arithmetic.
#include <CGAL/MP_Float.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "harness/base/random.h"
#include "tool_renderers/least_constraint.h"

namespace touchstone::tool_renderers {
namespace {

// min |y - u|^2 / 2, a y >= b. CGAL wants the matrix of y^T D y as 2 D.
std::optional<Vec6> exact(const std::vector<HalfSpace6>& half_spaces, const Vec6& u) {
  CGAL::Quadratic_program<double> program(CGAL::LARGER, false, 0, false, 0);  // no bounds on y
  for (int k = 0; k < 6; ++k) {
    program.set_d(k, k, 1.0);
    program.set_c(k, -u[k]);
  }
  for (std::size_t i = 0; i < half_spaces.size(); ++i) {
    for (int k = 0; k < 6; ++k) program.set_a(k, static_cast<int>(i), half_spaces[i].a[k]);
    program.set_b(static_cast<int>(i), half_spaces[i].b);
  }
  const auto solution = CGAL::solve_quadratic_program(program, CGAL::MP_Float());
  if (solution.is_infeasible()) return {};
  Vec6 y;
  int k = 0;
  for (auto value = solution.variable_values_begin(); value != solution.variable_values_end(); ++value)
    y[k++] = CGAL::to_double(*value);
  return y;
}

// Coordinates of a grid: a program whose exact answer takes moments, and sets that are degenerate by being on it.
double coarse(Random& random, double size) { return std::round(random.uniform(-size, size) * 8.0) / 8.0; }

TEST(LeastConstraint, AgreesWithAnExactQuadraticProgram) {
  Random random(81);
  int empty = 0;
  for (int trial = 0; trial < 150; ++trial) {
    std::vector<HalfSpace6> half_spaces(1 + random.below(12));
    for (HalfSpace6& h : half_spaces) {
      for (int k = 0; k < 6; ++k) h.a[k] = coarse(random, 2.0);
      h.b = coarse(random, 1.0);
    }
    // Contacts of a flat face: the same half-space twice, and one that is the sum of two.
    half_spaces.push_back(half_spaces[0]);
    half_spaces.push_back({half_spaces[0].a + half_spaces.back().a, half_spaces[0].b + half_spaces.back().b});
    Vec6 u;
    for (int k = 0; k < 6; ++k) u[k] = coarse(random, 3.0);
    const auto expected = exact(half_spaces, u);
    const LeastConstraint found = least_constraint(half_spaces, u, 1e-12);
    ASSERT_EQ(found.found, expected.has_value()) << trial;
    if (!expected) {
      ++empty;
      continue;
    }
    EXPECT_LE((found.y - *expected).norm(), 1e-9) << trial;
  }
  EXPECT_LT(empty, 75) << "most have a solution";
}

}  // namespace
}  // namespace touchstone::tool_renderers
