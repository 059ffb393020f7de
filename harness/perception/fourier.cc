#include "harness/perception/fourier.h"

#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace touchstone::perception {
namespace {

using Complex = std::complex<double>;

// exp(-i pi k / n), exact to rounding for any k: the angle is reduced before it is multiplied by pi.
Complex turn_of(std::size_t k, std::size_t n) {
  return std::polar(1.0, -std::numbers::pi * static_cast<double>(k % (2 * n)) / static_cast<double>(n));
}

// The library takes as long as n times the largest prime in n.
bool has_small_factors(std::size_t n) {
  for (const std::size_t prime : {2U, 3U, 5U, 7U, 11U, 13U}) {
    while (n % prime == 0) n /= prime;
  }
  return n == 1;
}

// Transforms of one length. Not for several threads at once.
class Transform {
 public:
  explicit Transform(std::size_t n) : n_(n) {
    for (std::size_t k = 0; k <= n / 2; ++k) turns_.push_back(turn_of(k, 2 * n));
    small_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
    small_.SetFlag(Eigen::FFT<double>::Unscaled);
    if (has_small_factors(n)) return;
    // Bluestein (1970), "A linear filtering approach to the computation of discrete Fourier transform": k j =
    // (k^2 + j^2 - (k - j)^2) / 2 makes a convolution of it, for which a length of two's powers serves.
    const std::size_t padded = std::bit_ceil(2 * n - 1);
    std::vector<Complex> chirp(padded);
    for (std::size_t k = 0; k < n; ++k) {
      chirp_.push_back(turn_of(k * k, n));
      chirp[k] = chirp[(padded - k) % padded] = std::conj(chirp_[k]);
    }
    filter_.resize(padded);
    large_.SetFlag(Eigen::FFT<double>::Unscaled);
    large_.fwd(filter_.data(), chirp.data(), static_cast<Eigen::Index>(padded));
  }

  [[nodiscard]] std::size_t size() const noexcept { return n_; }
  [[nodiscard]] const std::vector<Complex>& turns() const noexcept { return turns_; }  // exp(-i pi k / 2n), k = 0..n/2

  // `spectrum` has n/2 + 1 numbers.
  void forward(const std::vector<double>& x, std::vector<Complex>& spectrum) {
    if (chirp_.empty()) {
      if (n_ == 1) {
        spectrum[0] = x[0];
      } else {
        small_.fwd(spectrum.data(), x.data(), static_cast<Eigen::Index>(n_));
      }
      return;
    }
    const std::vector<Complex> whole = convolved({x.begin(), x.end()});
    std::copy_n(whole.begin(), spectrum.size(), spectrum.begin());
  }

  // n times the inverse.
  void backward(const std::vector<Complex>& spectrum, std::vector<double>& x) {
    if (chirp_.empty()) {
      if (n_ == 1) {
        x[0] = spectrum[0].real();
      } else {
        small_.inv(x.data(), spectrum.data(), static_cast<Eigen::Index>(n_));
      }
      return;
    }
    std::vector<Complex> whole(n_);  // its conjugate: forwards is then backwards
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      whole[k] = std::conj(spectrum[k]);
      if (k > 0) whole[n_ - k] = spectrum[k];
    }
    whole = convolved(std::move(whole));
    for (std::size_t i = 0; i < n_; ++i) x[i] = whole[i].real();
  }

 private:
  [[nodiscard]] std::vector<Complex> convolved(std::vector<Complex> x) {
    const std::size_t padded = filter_.size();
    for (std::size_t i = 0; i < n_; ++i) x[i] *= chirp_[i];
    x.resize(padded);
    std::vector<Complex> spectrum(padded);
    large_.fwd(spectrum.data(), x.data(), static_cast<Eigen::Index>(padded));
    for (std::size_t k = 0; k < padded; ++k) spectrum[k] *= filter_[k];
    large_.inv(x.data(), spectrum.data(), static_cast<Eigen::Index>(padded));
    x.resize(n_);
    for (std::size_t i = 0; i < n_; ++i) x[i] *= chirp_[i] / static_cast<double>(padded);
    return x;
  }

  std::size_t n_;
  Eigen::FFT<double> small_, large_;
  std::vector<Complex> turns_, chirp_, filter_;
};

// Half the cost of a transform is its table of sines: the lengths in use are kept.
Transform& transform_of(std::size_t n) {
  constexpr std::size_t most = 16;
  static thread_local std::map<std::size_t, std::unique_ptr<Transform>> kept;
  if (!kept.contains(n) && kept.size() >= most) kept.clear();
  std::unique_ptr<Transform>& found = kept[n];
  if (!found) found = std::make_unique<Transform>(n);
  return *found;
}

// Makhoul's order: the even samples forwards, then the odd ones backwards. Calls visit(place in order, sample).
template <class Visit>
void in_order(std::size_t n, Visit&& visit) {
  for (std::size_t i = 0; 2 * i < n; ++i) visit(i, 2 * i);
  for (std::size_t i = 0; 2 * i + 1 < n; ++i) visit(n - 1 - i, 2 * i + 1);
}

// Makes the transform orthonormal; the constant has twice the squares of the other cosines.
double scale_of(std::size_t n) { return std::sqrt(2.0 / static_cast<double>(n)); }

}  // namespace

std::vector<Complex> real_fourier(std::span<const double> x) {
  if (x.empty()) return {};
  std::vector<Complex> out(x.size() / 2 + 1);
  transform_of(x.size()).forward({x.begin(), x.end()}, out);
  return out;
}

std::vector<double> cosine_transform(std::span<const double> x) {
  const std::size_t n = x.size();
  if (n == 0) return {};
  Transform& transform = transform_of(n);
  std::vector<double> y(n);
  in_order(n, [&](std::size_t place, std::size_t sample) { y[place] = x[sample]; });
  std::vector<Complex> spectrum(n / 2 + 1);
  transform.forward(y, spectrum);
  const double scale = scale_of(n);
  y[0] = spectrum[0].real() * scale * std::sqrt(0.5);
  for (std::size_t k = 1; k < spectrum.size(); ++k) {
    const Complex& v = spectrum[k];
    const Complex& turn = transform.turns()[k];
    y[k] = scale * (turn.real() * v.real() - turn.imag() * v.imag());
    y[n - k] = -scale * (turn.real() * v.imag() + turn.imag() * v.real());
  }
  // In the middle of an even length both say the same.
  return y;
}

std::vector<double> inverse_cosine_transform(std::span<const double> coefficients) {
  const std::size_t n = coefficients.size();
  if (n == 0) return {};
  Transform& transform = transform_of(n);
  std::vector<Complex> spectrum(n / 2 + 1);
  const double scale = 0.5 * scale_of(n);
  spectrum[0] = coefficients[0] * scale * std::sqrt(2.0);
  for (std::size_t k = 1; k < spectrum.size(); ++k) {
    const double a = scale * coefficients[k];
    const double b = -scale * coefficients[n - k];
    const Complex& turn = transform.turns()[k];
    spectrum[k] = {turn.real() * a + turn.imag() * b, turn.real() * b - turn.imag() * a};
  }
  std::vector<double> ordered(n);
  transform.backward(spectrum, ordered);
  std::vector<double> x(n);
  in_order(n, [&](std::size_t place, std::size_t sample) { x[sample] = ordered[place]; });
  return x;
}

}  // namespace touchstone::perception
