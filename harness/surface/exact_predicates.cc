#include "harness/surface/exact_predicates.h"

#include <array>
#include <cmath>
#include <limits>

namespace touchstone::surface {
namespace {

struct TwoTerms {
  double high;
  double low;
};

// a + b and a * b without any error (Knuth; Dekker by way of fma).
TwoTerms two_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  const double a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}
TwoTerms two_product(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

// An exact sum of doubles: components that do not overlap, smallest first, none zero (grow-expansion with elimination
// of zeros). 48 products of three doubles give at most 192 components.
class Expansion {
 public:
  void add(double value) {
    if (value == 0.0) return;
    int kept = 0;
    for (int i = 0; i < size_; ++i) {
      const TwoTerms sum = two_sum(value, terms_[static_cast<std::size_t>(i)]);
      value = sum.high;
      if (sum.low != 0.0) terms_[static_cast<std::size_t>(kept++)] = sum.low;
    }
    if (value != 0.0) terms_[static_cast<std::size_t>(kept++)] = value;
    size_ = kept;
  }
  void add_product(double x, double y, double z) {
    if (x == 0.0 || y == 0.0 || z == 0.0) return;
    const TwoTerms xy = two_product(x, y);
    const TwoTerms high = two_product(xy.high, z);
    const TwoTerms low = two_product(xy.low, z);
    add(low.low);
    add(low.high);
    add(high.low);
    add(high.high);
  }
  // x . (y cross z)
  void add_determinant(const Vec3& x, const Vec3& y, const Vec3& z) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::Index j = (i + 1) % 3;
      const Eigen::Index k = (i + 2) % 3;
      add_product(x[i], y[j], z[k]);
      add_product(-x[i], y[k], z[j]);
    }
  }
  [[nodiscard]] int sign() const {
    if (size_ == 0) return 0;
    return terms_[static_cast<std::size_t>(size_ - 1)] > 0.0 ? 1 : -1;
  }

 private:
  std::array<double, 192> terms_{};
  int size_ = 0;
};

// b - a without any error: the rounded difference and what rounding took.
struct Difference {
  Vec3 high;
  Vec3 low;
  bool rounded = false;
  Difference(const Vec3& b, const Vec3& a) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      const TwoTerms exact = two_sum(b[i], -a[i]);
      high[i] = exact.high;
      low[i] = exact.low;
      rounded = rounded || exact.low != 0.0;
    }
  }
};

}  // namespace

int side_of_plane_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // In a flat part of a mesh every question comes here. First a plane across an axis.
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (a[i] == b[i] && a[i] == c[i] && a[i] == d[i]) return 0;
  }
  // det(b - a, c - a, d - a), multilinear in the differences' terms, of which most low ones are zero (Shewchuk 1997,
  // section 4.3, whose second stage stops where all are).
  const Difference u(b, a);
  const Difference v(c, a);
  const Difference w(d, a);
  Expansion sum;
  for (unsigned low = 0; low < 8; ++low) {
    const bool low_u = (low & 1U) != 0;
    const bool low_v = (low & 2U) != 0;
    const bool low_w = (low & 4U) != 0;
    if ((low_u && !u.rounded) || (low_v && !v.rounded) || (low_w && !w.rounded)) continue;
    sum.add_determinant(low_u ? u.low : u.high, low_v ? v.low : v.high, low_w ? w.low : w.high);
  }
  return sum.sign();
}

int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return side_of_plane_of<double>(a, b, c, d);
}

}  // namespace touchstone::surface
