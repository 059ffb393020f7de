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
// of zeros). 24 products of three doubles give at most 96 components.
class Expansion {
 public:
  void add(double value) {
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
    const TwoTerms xy = two_product(x, y);
    const TwoTerms high = two_product(xy.high, z);
    const TwoTerms low = two_product(xy.low, z);
    add(low.low);
    add(low.high);
    add(high.low);
    add(high.high);
  }
  // x times the 2x2 determinant of (y, z).
  void add_minor(const Vec3& x, const Vec3& y, const Vec3& z, double sign) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::Index j = (i + 1) % 3;
      const Eigen::Index k = (i + 2) % 3;
      add_product(sign * x[i], y[j], z[k]);
      add_product(-sign * x[i], y[k], z[j]);
    }
  }
  [[nodiscard]] int sign() const {
    if (size_ == 0) return 0;
    return terms_[static_cast<std::size_t>(size_ - 1)] > 0.0 ? 1 : -1;
  }

 private:
  std::array<double, 100> terms_{};
  int size_ = 0;
};

}  // namespace

int side_of_plane_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // det(b - a, c - a, d - a) by multilinearity.
  Expansion sum;
  sum.add_minor(b, c, d, 1.0);
  sum.add_minor(a, c, d, -1.0);
  sum.add_minor(a, b, d, 1.0);
  sum.add_minor(a, b, c, -1.0);
  return sum.sign();
}

int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return side_of_plane_of<double>(a, b, c, d);
}

}  // namespace touchstone::surface
