#include "renderers/friction/nearest_in_polyhedron.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/counted.h"
#include "renderers/friction/fixed_order.h"

namespace touchstone::renderers {
namespace {

using Basis = std::array<std::int32_t, 3>;

// On the planes of the basis, nearest to p; false where they have no common point, or where one of them pulls.
template <class S>
bool on_planes(std::span<const HalfSpaceOf<S>> all, const Basis& basis, int size, const Vec3Of<S>& p,
               Vec3Of<S>& x) noexcept {
  const auto plane = [&](int i) -> const HalfSpaceOf<S>& {
    return all[static_cast<std::size_t>(basis[static_cast<std::size_t>(i)])];
  };
  if (size == 1) {
    const S l = plane(0).b - dot(plane(0).n, p);
    x = p + l * plane(0).n;
    return l >= S(0.0);
  }
  // Solved in the orthonormal frame of the normals (Gram-Schmidt): half the digits would be lost in normal equations.
  std::array<Vec3Of<S>, 3> q;
  std::array<std::array<S, 3>, 3> r{};  // n_i = sum_j r[i][j] q_j
  std::array<S, 3> y{};                 // x - p in the frame
  for (int i = 0; i < size; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Vec3Of<S> rest = plane(i).n;
    for (std::size_t j = 0; j < k; ++j) {
      r[k][j] = dot(q[j], plane(i).n);
      rest -= r[k][j] * q[j];
    }
    r[k][k] = norm(rest);
    if (!(r[k][k] > S(16.0 * std::numeric_limits<double>::epsilon()))) return false;
    q[k] = rest / r[k][k];
    S known = dot(plane(i).n, p);
    for (std::size_t j = 0; j < k; ++j) known += r[k][j] * y[j];
    y[k] = (plane(i).b - known) / r[k][k];
  }
  x = p;
  for (std::size_t j = 0; j < static_cast<std::size_t>(size); ++j) x += y[j] * q[j];
  // The multipliers: sum_i l_i n_i = x - p, triangular from the last.
  std::array<S, 3> l{};
  for (std::size_t i = static_cast<std::size_t>(size); i-- > 0;) {
    S sum = y[i];
    for (std::size_t j = i + 1; j < static_cast<std::size_t>(size); ++j) sum -= r[j][i] * l[j];
    l[i] = sum / r[i][i];
    if (l[i] < S(0.0)) return false;
  }
  return true;
}

}  // namespace

template <class S>
NearestInPolyhedronOf<S> nearest_in_polyhedron_of(std::span<const HalfSpaceOf<S>> half_spaces, const Vec3Of<S>& p,
                                                  const S& rounding) noexcept {
  NearestInPolyhedronOf<S> now;
  now.x = p;
  now.found = true;
  const auto violation = [&](std::int32_t i, const Vec3Of<S>& x) -> S {
    const HalfSpaceOf<S>& h = half_spaces[static_cast<std::size_t>(i)];
    return h.b - dot(h.n, x);
  };
  for (std::size_t round = 0; round < 4 * half_spaces.size() + 8; ++round) {
    std::int32_t worst = -1;
    S most = rounding;
    for (std::size_t i = 0; i < half_spaces.size(); ++i) {
      if (const S v = violation(static_cast<std::int32_t>(i), now.x); v > most) {
        most = v;
        worst = static_cast<std::int32_t>(i);
      }
    }
    if (worst < 0) return now;
    // Every basis of the old one and the new half-space that contains the new one; the fewer planes the better.
    NearestInPolyhedronOf<S> best;
    S least = S(std::numeric_limits<double>::infinity());
    for (unsigned chosen = 0; chosen < (1U << now.basis_size); ++chosen) {
      Basis basis{worst, -1, -1};
      int size = 1;
      bool fits = true;
      for (int i = 0; i < now.basis_size; ++i) {
        if ((chosen >> i & 1U) == 0) continue;
        if (size == 3) {
          fits = false;
          break;
        }
        basis[static_cast<std::size_t>(size++)] = now.basis[static_cast<std::size_t>(i)];
      }
      Vec3Of<S> x;
      if (!fits || !on_planes<S>(half_spaces, basis, size, p, x)) continue;
      S left = violation(worst, x);
      for (int i = 0; i < now.basis_size; ++i)
        left = std::max(left, violation(now.basis[static_cast<std::size_t>(i)], x));
      if (left > rounding) continue;
      if (const S distance = squared_distance(x, p); distance < least) {
        least = distance;
        best.x = x;
        best.basis = basis;
        best.basis_size = size;
        best.found = true;
      }
    }
    if (!best.found) {
      now.found = false;
      return now;
    }
    now = best;
  }
  now.found = false;
  return now;
}

template <class S>
bool nearest_on_planes(std::span<const HalfSpaceOf<S>> planes, const Vec3Of<S>& p, Vec3Of<S>& x) noexcept {
  return on_planes<S>(planes, Basis{0, 1, 2}, static_cast<int>(planes.size()), p, x);
}

template bool nearest_on_planes(std::span<const HalfSpace>, const Vec3&, Vec3&) noexcept;
template bool nearest_on_planes(std::span<const HalfSpaceOf<Counted>>, const Vec3Of<Counted>&,
                                Vec3Of<Counted>&) noexcept;
template NearestInPolyhedron nearest_in_polyhedron_of<double>(std::span<const HalfSpace>, const Vec3&,
                                                              const double&) noexcept;
template NearestInPolyhedronOf<Counted> nearest_in_polyhedron_of<Counted>(std::span<const HalfSpaceOf<Counted>>,
                                                                          const Vec3Of<Counted>&,
                                                                          const Counted&) noexcept;

}  // namespace touchstone::renderers
