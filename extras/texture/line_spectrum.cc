#include "line_spectrum.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "texture_model.h"

namespace touchstone::texture {
namespace {

// Multiplies the polynomial in z^-1 with `length` places by 1 + c z^-1 + d z^-2; its length is then two more.
void multiply(std::span<double> polynomial, std::size_t& length, double c, double d) noexcept {
  polynomial[length] = polynomial[length + 1] = 0.0;
  length += 2;
  for (std::size_t i = length; i-- > 0;) {
    double value = polynomial[i];
    if (i >= 1) value += c * polynomial[i - 1];
    if (i >= 2) value += d * polynomial[i - 2];
    polynomial[i] = value;
  }
}

// Takes the factor 1 + r z^-1, which it has, out of the polynomial.
void divide(std::vector<double>& polynomial, double r) {
  for (std::size_t i = 1; i < polynomial.size(); ++i) polynomial[i] -= r * polynomial[i - 1];
  polynomial.pop_back();
}

// The angles between 0 and pi of the zeros, by the eigenvalues of the companion matrix.
void add_angles(const std::vector<double>& polynomial, std::vector<double>& angles) {
  const auto degree = static_cast<Eigen::Index>(polynomial.size()) - 1;
  if (degree < 1) return;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  for (Eigen::Index i = 0; i < degree; ++i) companion(0, i) = -polynomial[static_cast<std::size_t>(i) + 1];
  for (Eigen::Index i = 1; i < degree; ++i) companion(i, i - 1) = 1.0;
  const Eigen::VectorXcd zeros = companion.eigenvalues();
  for (const std::complex<double>& zero : zeros) {
    if (zero.imag() > 0.0) angles.push_back(std::arg(zero));
  }
}

// The step-down recursion (Markel and Gray 1976, chapter 5): the zeros lie inside the unit circle exactly if all
// reflection coefficients do.
bool stable(std::span<const double> polynomial) {
  std::vector<double> a(polynomial.begin(), polynomial.end());
  while (a.size() > 1) {
    const double k = a.back();
    if (!(std::abs(k) < 1.0)) return false;
    std::vector<double> lower(a.size() - 1);
    for (std::size_t i = 0; i < lower.size(); ++i) lower[i] = (a[i] - k * a[a.size() - 1 - i]) / (1.0 - k * k);
    a = std::move(lower);
  }
  return true;
}

}  // namespace

void polynomial_of(std::span<const double> angles_rad, std::span<double> out) noexcept {
  const std::size_t p = angles_rad.size();
  std::array<double, most_coefficients + 4> sum{1.0};
  std::array<double, most_coefficients + 4> difference{1.0};
  std::size_t sum_length = 1;
  std::size_t difference_length = 1;
  for (std::size_t i = 0; i < p; ++i) {
    const double c = -2.0 * std::cos(angles_rad[i]);
    if (i % 2 == 0) {
      multiply(sum, sum_length, c, 1.0);
    } else {
      multiply(difference, difference_length, c, 1.0);
    }
  }
  // Zeros at -1 and 1 that every such pair has.
  if (p % 2 == 0) {
    multiply(sum, sum_length, 1.0, 0.0);
    multiply(difference, difference_length, -1.0, 0.0);
  } else {
    multiply(difference, difference_length, 0.0, -1.0);
  }
  for (std::size_t i = 0; i <= p; ++i) out[i] = 0.5 * (sum[i] + difference[i]);
}

std::vector<double> line_spectral_frequencies(std::span<const double> polynomial) {
  const std::size_t p = polynomial.size() - 1;
  if (!stable(polynomial)) throw std::domain_error("a zero of the polynomial lies on or outside the unit circle");
  std::vector<double> sum(p + 2, 0.0);
  std::vector<double> difference(p + 2, 0.0);
  for (std::size_t i = 0; i <= p + 1; ++i) {
    const double forward = i <= p ? polynomial[i] : 0.0;
    const double backward = i >= 1 ? polynomial[p + 1 - i] : 0.0;
    sum[i] = forward + backward;
    difference[i] = forward - backward;
  }
  divide(difference, -1.0);
  divide(p % 2 == 0 ? sum : difference, 1.0);
  std::vector<double> angles;
  add_angles(sum, angles);
  add_angles(difference, angles);
  std::ranges::sort(angles);
  if (angles.size() != p) throw std::domain_error("a zero of the polynomial lies too near the unit circle");
  return angles;
}

}  // namespace touchstone::texture
