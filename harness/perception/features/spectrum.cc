#include "harness/perception/features/spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/perception/fourier.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {

Spectrum amplitude_spectrum(std::span<const double> x, double rate_Hz, double limit_Hz) {
  Spectrum result;
  if (x.empty()) return result;
  const double centre = stats::mean(x);
  std::vector<double> windowed(x.size());
  // cos(2 pi n / N) by turning a unit vector: its rounding grows like n eps, far below the window's purpose.
  const double angle = 2.0 * std::numbers::pi / static_cast<double>(x.size());
  const std::complex<double> turn(std::cos(angle), std::sin(angle));
  std::complex<double> phase(1.0, 0.0);
  for (std::size_t n = 0; n < x.size(); ++n) {
    windowed[n] = (x[n] - centre) * 0.5 * (1.0 - phase.real());
    phase *= turn;
  }
  const auto coefficients = real_fourier(windowed);
  result.step_Hz = rate_Hz / static_cast<double>(x.size());
  const auto wanted = static_cast<std::size_t>(std::max(1.0, std::floor(limit_Hz / result.step_Hz) + 1.0));
  // 2 / N for a one-sided amplitude, 2 for the Hann window's mean of one half.
  const double scale = 4.0 / static_cast<double>(x.size());
  for (std::size_t k = 0; k < std::min(wanted, coefficients.size()); ++k) {
    result.amplitude.push_back(scale * std::abs(coefficients[k]));
  }
  return result;
}

double harmonic_share(const Spectrum& spectrum) {
  const auto& a = spectrum.amplitude;
  if (a.size() < 3) return 0.0;
  const auto peak = std::max_element(a.begin() + 1, a.end());
  const auto base = static_cast<std::size_t>(peak - a.begin());
  const auto energy = [&a](std::size_t k) {
    double sum = 0.0;
    for (std::size_t i = k == 0 ? 0 : k - 1; i <= k + 1 && i < a.size(); ++i) sum += a[i] * a[i];
    return sum;
  };
  const double fundamental = energy(base);
  if (!(fundamental > 0.0)) return 0.0;
  double harmonics = 0.0;
  for (std::size_t k = 2 * base; k < a.size(); k += base) harmonics += energy(k);
  return std::sqrt(harmonics / fundamental);
}

}  // namespace touchstone::perception
