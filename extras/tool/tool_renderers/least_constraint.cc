#include "tool_renderers/least_constraint.h"

#include <Eigen/Cholesky>
#include <limits>

namespace touchstone::tool_renderers {

LeastConstraint least_constraint(std::span<const HalfSpace6> half_spaces, const Vec6& u, double rounding) noexcept {
  // Each exchange lengthens |y - u|, so no set comes twice; this many mean that rounding decides.
  constexpr int most_exchanges = 400;
  // Of |a|^2: a direction within rounding of the span of the active ones.
  constexpr double dependent = 1e-12;
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  using SmallVec = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

  LeastConstraint result;
  result.y = u;
  const auto drop = [&](int k) {
    for (int j = k; j + 1 < result.active_count; ++j) {
      result.active[std::size_t(j)] = result.active[std::size_t(j) + 1];
      result.multiplier[std::size_t(j)] = result.multiplier[std::size_t(j) + 1];
    }
    --result.active_count;
  };
  int exchanges = 0;
  while (true) {
    int worst = -1;
    double violation = rounding;
    for (std::size_t i = 0; i < half_spaces.size(); ++i) {
      const double below = half_spaces[i].b - half_spaces[i].a.dot(result.y);
      if (below > violation) {
        violation = below;
        worst = static_cast<int>(i);
      }
    }
    if (worst < 0) {
      result.found = true;
      return result;
    }
    const HalfSpace6& entering = half_spaces[std::size_t(worst)];
    double multiplier = 0.0;
    bool full = false;
    while (!full) {
      if (++exchanges > most_exchanges) return result;
      const int n = result.active_count;
      // r: how the active multipliers give way; z: the part of the new direction that they leave.
      SmallVec r(n);
      Vec6 z = entering.a;
      if (n > 0) {
        Small gram(n, n);
        SmallVec along(n);
        for (int i = 0; i < n; ++i) {
          const Vec6& a = half_spaces[std::size_t(result.active[std::size_t(i)])].a;
          along[i] = a.dot(entering.a);
          for (int j = 0; j <= i; ++j)
            gram(i, j) = gram(j, i) = a.dot(half_spaces[std::size_t(result.active[std::size_t(j)])].a);
        }
        r = Eigen::LLT<Small>(gram).solve(along);
        for (int i = 0; i < n; ++i) z -= r[i] * half_spaces[std::size_t(result.active[std::size_t(i)])].a;
      }
      const double square = z.squaredNorm();
      const bool moves = n < 6 && square > dependent * entering.a.squaredNorm();
      const double infinite = std::numeric_limits<double>::infinity();
      const double whole = moves ? (entering.b - entering.a.dot(result.y)) / square : infinite;
      double step = whole;
      int leaving = -1;
      for (int i = 0; i < n; ++i) {
        if (r[i] > 0.0 && result.multiplier[std::size_t(i)] / r[i] < step) {
          step = result.multiplier[std::size_t(i)] / r[i];
          leaving = i;
        }
      }
      if (!(step < infinite)) return result;  // empty
      if (moves) result.y += step * z;
      for (int i = 0; i < n; ++i) result.multiplier[std::size_t(i)] -= step * r[i];
      multiplier += step;
      if (leaving >= 0) {
        drop(leaving);
      } else {
        result.active[std::size_t(n)] = worst;
        result.multiplier[std::size_t(n)] = multiplier;
        ++result.active_count;
        full = true;
      }
    }
  }
}

}  // namespace touchstone::tool_renderers
