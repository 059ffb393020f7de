// Linear algebra of three dimensions whose sums are taken in a fixed order, so that it gives the same bits over double
// and over the scalar that counts (harness/base/counted.h): beside dot(), squared_norm() and unit() of vec.h. The
// orders are those of Eigen's own for double, packets of two.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "harness/base/vec.h"

namespace touchstone::renderers {

// In a servo step these are called too often to be called.
template <class S>
[[gnu::always_inline]] inline S squared_distance(const Vec3Of<S>& a, const Vec3Of<S>& b) {
  const S x = a.x() - b.x();
  const S y = a.y() - b.y();
  const S z = a.z() - b.z();
  return (x * x + y * y) + z * z;
}
template <class S>
[[gnu::always_inline]] inline S distance(const Vec3Of<S>& a, const Vec3Of<S>& b) {
  using std::sqrt;
  return sqrt(squared_distance(a, b));
}
template <class S>
[[gnu::always_inline]] inline S norm(const Vec3Of<S>& a) {
  using std::sqrt;
  return sqrt((a.x() * a.x() + a.y() * a.y()) + a.z() * a.z());
}

// The largest magnitude of a coordinate.
template <class S>
S largest(const Vec3Of<S>& a) {
  using std::abs;
  return std::max(std::max(abs(a.x()), abs(a.y())), abs(a.z()));
}

template <class S>
bool finite(const Vec3Of<S>& a) {
  using std::isfinite;
  return isfinite(a.x()) && isfinite(a.y()) && isfinite(a.z());
}

template <class S>
bool is_zero(const Vec3Of<S>& a) {
  const S zero(0.0);
  return a.x() == zero && a.y() == zero && a.z() == zero;
}

// a' b: sums of three.
template <class S, int R, int C>
Eigen::Matrix<S, R, C> inner_products(const Eigen::Matrix<S, 3, R>& a, const Eigen::Matrix<S, 3, C>& b) {
  Eigen::Matrix<S, R, C> out;
  for (Eigen::Index i = 0; i < R; ++i) {
    for (Eigen::Index j = 0; j < C; ++j) out(i, j) = dot(a.col(i), b.col(j));
  }
  return out;
}

// a b. Of three rows the last is the one that does not fill a packet: its sum begins at the end.
template <class S, int R, int K, int C>
Eigen::Matrix<S, R, C> product(const Eigen::Matrix<S, R, K>& a, const Eigen::Matrix<S, K, C>& b) {
  static_assert(K == 2 || K == 3);
  Eigen::Matrix<S, R, C> out;
  for (Eigen::Index i = 0; i < R; ++i) {
    for (Eigen::Index j = 0; j < C; ++j) {
      const S first = a(i, 0) * b(0, j);
      const S second = a(i, 1) * b(1, j);
      if constexpr (K == 2) {
        out(i, j) = first + second;
      } else {
        const S third = a(i, 2) * b(2, j);
        out(i, j) = i == 2 ? S(first + (second + third)) : S((first + second) + third);
      }
    }
  }
  return out;
}

// By cofactors; false, and nothing written, where |det| is not above `least`.
template <class S>
bool invert(const Eigen::Matrix<S, 2, 2>& a, double least, Eigen::Matrix<S, 2, 2>& inverse) {
  using std::abs;
  const S det = a(0, 0) * a(1, 1) - a(1, 0) * a(0, 1);
  if (!(abs(det) > S(least))) return false;
  const S by = S(1.0) / det;
  inverse << a(1, 1) * by, -a(0, 1) * by, -a(1, 0) * by, a(0, 0) * by;
  return true;
}
template <class S>
bool invert(const Eigen::Matrix<S, 3, 3>& a, double least, Eigen::Matrix<S, 3, 3>& inverse) {
  using std::abs;
  const auto cofactor = [&](Eigen::Index i, Eigen::Index j) -> S {
    const Eigen::Index i1 = (i + 1) % 3;
    const Eigen::Index i2 = (i + 2) % 3;
    const Eigen::Index j1 = (j + 1) % 3;
    const Eigen::Index j2 = (j + 2) % 3;
    return a(i1, j1) * a(i2, j2) - a(i1, j2) * a(i2, j1);
  };
  const Vec3Of<S> first(cofactor(0, 0), cofactor(1, 0), cofactor(2, 0));
  const S det = dot(first, a.col(0));
  if (!(abs(det) > S(least))) return false;
  const S by = S(1.0) / det;
  for (Eigen::Index j = 0; j < 3; ++j) {
    inverse(0, j) = first[j] * by;
    inverse(1, j) = cofactor(j, 1) * by;
    inverse(2, j) = cofactor(j, 2) * by;
  }
  return true;
}

}  // namespace touchstone::renderers
