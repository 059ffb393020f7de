#include "harness/stats/series_mean.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/stats/distributions.h"

namespace touchstone::stats {
namespace {

double mean_of(std::span<const double> series) {
  double sum = 0.0;
  for (const double x : series) sum += x;
  return sum / static_cast<double>(series.size());
}

// The last lag that is correlated: after it, five lags in a row lie within the band of a white series. At most a
// quarter of the series is looked at.
std::size_t last_correlated_lag(std::span<const double> series, double mean) {
  constexpr std::size_t quiet = 5;
  const auto n = static_cast<double>(series.size());
  const auto covariance = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < series.size(); ++i) sum += (series[i] - mean) * (series[i - lag] - mean);
    return sum / n;
  };
  const double variance = covariance(0);
  if (!(variance > 1e-24 * mean * mean)) return 0;  // rounding
  const double band = 2.0 * std::sqrt(std::log10(n) / n) * variance;
  const std::size_t most = series.size() / 4;
  std::size_t last = 0;
  for (std::size_t lag = 1; lag <= most && lag - last <= quiet; ++lag) {
    if (std::abs(covariance(lag)) >= band) last = lag;
  }
  return last;
}

}  // namespace

SeriesMean series_mean(std::span<const double> series) {
  SeriesMean out;
  if (series.empty()) return out;
  const auto n = static_cast<double>(series.size());
  out.mean = mean_of(series);
  if (!std::isfinite(out.mean)) return out;
  const auto longest = static_cast<double>(std::max<std::size_t>(1, last_correlated_lag(series, out.mean)));
  constexpr double short_series = 150.0;
  constexpr double lengths_of_a_degree = 5.0;
  const double degrees =
      std::floor(std::min(n < short_series ? fewest_degrees : most_degrees, n / (lengths_of_a_degree * longest)));
  if (degrees < fewest_degrees) return out;
  out.degrees = degrees;
  double long_run = 0.0;
  for (int j = 1; j <= static_cast<int>(degrees); ++j) {
    double projection = 0.0;
    for (std::size_t i = 0; i < series.size(); ++i)
      projection += series[i] * std::cos(std::numbers::pi * j * (static_cast<double>(i) + 0.5) / n);
    long_run += 2.0 / n * projection * projection / degrees;
  }
  out.standard_error = std::sqrt(long_run / n);
  // Rounding of a constant series is no spread.
  if (out.standard_error > 1e-9 * std::abs(out.mean)) {
    out.p = student_p(out.mean / out.standard_error, degrees);
  } else {
    out.standard_error = 0.0;
    out.p = out.mean == 0.0 ? 1.0 : 0.0;
  }
  return out;
}

}  // namespace touchstone::stats
