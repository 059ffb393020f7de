#include "harness/discrepancy/welch.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {

std::size_t fast_length(std::size_t n) {
  for (; n > 1; --n) {
    std::size_t rest = n;
    for (const std::size_t factor : {2U, 3U, 5U}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1 && n % 2 == 0) return n;
  }
  return n;
}

double median_step_s(const std::vector<double>& t_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t_s.size(); ++i) steps.push_back(t_s[i] - t_s[i - 1]);
  return steps.empty() ? 0.0 : stats::lower_quantile(std::move(steps), 0.5);
}

Axes even(const std::vector<double>& t_s, const std::vector<Vec3>& series, double step_s) {
  const auto n = static_cast<std::size_t>((t_s.back() - t_s.front()) / step_s + 0.5) + 1;
  Axes axes;
  for (auto& axis : axes) axis.resize(n);
  // Straight between the two samples about each new time; beyond the ends the last value stands (`share` clamped).
  std::size_t j = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = t_s.front() + static_cast<double>(i) * step_s;
    while (j + 2 < t_s.size() && t_s[j + 1] <= t) ++j;
    const double share = std::clamp((t - t_s[j]) / (t_s[j + 1] - t_s[j]), 0.0, 1.0);
    const Vec3 value = series[j] + share * (series[j + 1] - series[j]);
    for (int a = 0; a < 3; ++a) axes.at(static_cast<std::size_t>(a))[i] = value[a];
  }
  return axes;
}

Spectra welch(const Axes& axes, double step_s, std::size_t length) {
  Spectra spectra;
  const std::size_t n = axes[0].size();
  const std::size_t hop = length / 2;
  const std::size_t segments = 1 + (n - length) / hop;
  spectra.bin_Hz = 1.0 / (static_cast<double>(length) * step_s);
  // Neighbouring segments share samples: K of them vary like K / (1 + 2 rho^2 (K - 1) / K) independent ones, with
  // rho = 1/6. Hann tapers that overlap by a half correlate by 1/6 (Welch 1967, equation 11 and below).
  const auto count = static_cast<double>(segments);
  spectra.averages = count / (1.0 + 2.0 / 36.0 * (count - 1.0) / count);
  std::vector<double> taper(length);
  double square = 0.0;
  for (std::size_t i = 0; i < length; ++i) {
    taper[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length));
    square += taper[i] * taper[i];
  }
  Eigen::FFT<double> transform;
  std::vector<double> piece(length);
  std::vector<std::complex<double>> frequencies;
  for (std::size_t a = 0; a < 3; ++a) {
    auto& power = spectra.power_N2.at(a);
    power.assign(length / 2 + 1, 0.0);
    for (std::size_t s = 0; s < segments; ++s) {
      const auto begin = axes.at(a).begin() + static_cast<std::ptrdiff_t>(s * hop);
      // Without its mean: the taper would smear what stands still into the lowest bins.
      double mean = 0.0;
      for (std::size_t i = 0; i < length; ++i) mean += begin[static_cast<std::ptrdiff_t>(i)];
      mean /= static_cast<double>(length);
      for (std::size_t i = 0; i < length; ++i) piece[i] = taper[i] * (begin[static_cast<std::ptrdiff_t>(i)] - mean);
      transform.fwd(frequencies, piece);
      for (std::size_t k = 0; k < power.size(); ++k) {
        // |X_k|^2 over (length sum of taper^2): by Parseval's theorem the bins of both sides add up to the mean square,
        // whatever the taper takes off. Twice, as the other side holds the same.
        power[k] += 2.0 * std::norm(frequencies[k]) / (square * static_cast<double>(length) * count);
      }
    }
  }
  return spectra;
}

std::vector<double> running_mean(const std::vector<double>& values, std::size_t reach) {
  // From running sums: the mean over [low, high) is their difference over its length, shorter at the ends.
  std::vector<double> sums(values.size() + 1, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) sums[i + 1] = sums[i] + values[i];
  std::vector<double> means(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t low = i > reach ? i - reach : 0;
    const std::size_t high = std::min(values.size(), i + reach + 1);
    means[i] = (sums[high] - sums[low]) / static_cast<double>(high - low);
  }
  return means;
}

}  // namespace touchstone::discrepancy
