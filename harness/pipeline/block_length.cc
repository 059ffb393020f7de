#include "harness/pipeline/block_length.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace touchstone::pipeline {

namespace {

struct Spectrum {
  double variance = 0.0;
  double spread = 0.0;  // twice pi times the spectral density at zero, by the flat-top window
  double slope = 0.0;   // sum of |lag| times the windowed covariance
};

Spectrum spectrum_at_zero(std::span<const double> series) {
  const std::size_t n = series.size();
  double mean = 0.0;
  for (const double x : series) mean += x / static_cast<double>(n);
  const auto covariance = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) sum += (series[i] - mean) * (series[i - lag] - mean);
    return sum / static_cast<double>(n);
  };
  const double variance = covariance(0);
  // Rounding of the mean is no variation.
  if (n < 8 || !(variance > 1e-28 * mean * mean)) return {variance, variance, 0.0};
  // The last lag that is correlated: after it, `quiet` lags in a row lie within the band of a white series.
  const double band = 2.0 * std::sqrt(std::log10(static_cast<double>(n)) / static_cast<double>(n));
  const auto quiet = static_cast<std::size_t>(std::max(5.0, std::ceil(std::sqrt(std::log10(static_cast<double>(n))))));
  const std::size_t most =
      std::min(n / 4, static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n)))) + quiet);
  std::vector<double> r{variance};
  std::size_t last = 0;
  for (std::size_t lag = 1; lag <= most && lag - last <= quiet; ++lag) {
    r.push_back(covariance(lag));
    if (std::abs(r.back()) / variance >= band) last = lag;
  }
  Spectrum out{variance, variance, 0.0};
  const std::size_t width = std::min(2 * last, most);
  for (std::size_t lag = 1; lag <= width; ++lag) {
    while (r.size() <= lag) r.push_back(covariance(r.size()));
    const double t = static_cast<double>(lag) / static_cast<double>(width);
    const double window = t <= 0.5 ? 1.0 : 2.0 * (1.0 - t);
    out.spread += 2.0 * window * r[lag];
    out.slope += 2.0 * window * static_cast<double>(lag) * r[lag];
  }
  return out;
}

}  // namespace

std::size_t automatic_block_length(std::span<const double> series) {
  const std::size_t n = series.size();
  const Spectrum s = spectrum_at_zero(series);
  const double d = 4.0 / 3.0 * s.spread * s.spread;
  if (!(d > 0.0)) return 1;
  const double length = std::cbrt(2.0 * s.slope * s.slope / d * static_cast<double>(n));
  return std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(length)), 1, std::max<std::size_t>(1, n / 4));
}

}  // namespace touchstone::pipeline
