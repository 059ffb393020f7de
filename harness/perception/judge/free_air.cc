#include "harness/perception/judge/free_air.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/base/vec.h"
#include "harness/perception/judge/growth.h"
#include "harness/stats/quantile.h"

namespace touchstone::perception {
namespace {

constexpr double kWindow_s = 0.05;
constexpr double kPull_s = 0.02;
constexpr double kRelease_s = 0.1;
constexpr double kMargin_s = 0.024;  // longer than the smoothing of positions
constexpr std::size_t kFewestWindows = 4;
constexpr std::size_t kFewestReleases = 2;

std::size_t samples_of(double duration_s, const FeltSeries& felt) {
  return static_cast<std::size_t>(std::max(1.0, std::round(duration_s * felt.rate_Hz)));
}

struct MeanOf {
  double value = 0.0;
  double error = 0.0;
};

MeanOf mean_of(const std::vector<double>& x) {
  const auto n = static_cast<double>(x.size());
  MeanOf result;
  if (x.empty()) return result;
  for (const double value : x) result.value += value / n;
  double squares = 0.0;
  for (const double value : x) squares += (value - result.value) * (value - result.value);
  result.error = n > 1.0 ? std::sqrt(squares / (n * (n - 1.0))) : std::abs(result.value);
  return result;
}

// The squared mean force of the window less what its own noise adds, if that is white.
double squared_force_N2(const FeltSeries& felt, std::size_t first, std::size_t length) {
  const auto n = static_cast<double>(length);
  double result = 0.0;
  for (const auto& axis : felt.force_N) {
    double mean = 0.0;
    for (std::size_t i = first; i < first + length; ++i) mean += axis[i] / n;
    double squares = 0.0;
    for (std::size_t i = first; i < first + length; ++i) squares += (axis[i] - mean) * (axis[i] - mean);
    result += mean * mean - squares / (n * (n - 1.0));
  }
  return result;
}

}  // namespace

FreeAir free_air(const FeltSeries& felt, const Response& response) {
  const std::size_t n = felt.size();
  const std::size_t release = samples_of(kRelease_s, felt);
  const std::size_t margin = samples_of(kMargin_s, felt);
  const std::size_t pull = samples_of(kPull_s, felt);
  const std::size_t window = std::max<std::size_t>(4, samples_of(kWindow_s, felt));
  const auto touches = [&](std::size_t i) { return felt.depth_m[i] >= response.contact_m; };
  // Where contact begins is known to a part of the depth: close to it is neither.
  const auto far = [&](std::size_t i) { return felt.depth_m[i] < response.contact_m - response.grid.spacing_m; };
  std::vector<double> pulls_N;
  std::vector<double> leaving_m_per_s;
  std::vector<double> squares_N2;
  std::size_t i = 0;
  while (i < n) {
    if (touches(i)) {
      ++i;
      continue;
    }
    const std::size_t first = i;
    while (i < n && !touches(i)) ++i;
    std::size_t from = first;
    if (first > 0) {
      const std::size_t last = std::min(i, first + release);
      double most_N = 0.0;
      for (std::size_t at = first; at + pull <= last; ++at) {
        double sum_N = 0.0;
        for (std::size_t k = at; k < at + pull; ++k) sum_N -= felt.force_N[0][k];
        most_N = std::max(most_N, sum_N / static_cast<double>(pull));
      }
      pulls_N.push_back(most_N);
      leaving_m_per_s.push_back(std::abs(felt.rate_of_depth_m_per_s[first]));
      from = last;
    }
    const std::size_t until = i < n ? i - std::min(i, margin) : n;
    for (std::size_t at = from; at + window <= until;) {
      if (!far(at) || !far(at + window - 1)) {
        ++at;
        continue;
      }
      squares_N2.push_back(squared_force_N2(felt, at, window));
      at += window;
    }
  }
  FreeAir result;
  const MeanOf square = mean_of(squares_N2);
  result.windows = squares_N2.size();
  result.force_N = std::sqrt(std::max(0.0, square.value));
  // Of a root: half the relative error of the square, and where the square is all error its root.
  const double spread_N2 = square.error * std::sqrt(static_cast<double>(squares_N2.size()));
  result.force_spread_N =
      result.force_N * result.force_N > spread_N2 ? 0.5 * spread_N2 / result.force_N : std::sqrt(spread_N2);
  const MeanOf pulled = mean_of(pulls_N);
  result.releases = pulls_N.size();
  result.pull_N = pulled.value;
  result.pull_error_N = pulled.error;
  if (!leaving_m_per_s.empty()) result.leaving_m_per_s = stats::median(leaving_m_per_s);
  return result;
}

AirDifference air_difference(const FreeAir& real, const FreeAir& rendered, bool same_motion,
                             const Thresholds& thresholds) {
  const NoticeableSteps steps(thresholds.force);
  const auto compared = [&](bool release, double real_N, double real_error_N, double rendered_N,
                            double rendered_error_N) {
    AirDifference result{true, release, std::abs(steps(rendered_N) - steps(real_N)), 0.0, real_N, rendered_N};
    const double both_N = same_motion ? 0.0 : std::min(real_N, rendered_N);
    const double error = std::hypot(steps(real_N + real_error_N) - steps(real_N),
                                    steps(rendered_N + rendered_error_N) - steps(rendered_N));
    result.standard_error = std::hypot(error, steps(2.0 * both_N) - steps(both_N));
    return result;
  };
  AirDifference best;
  if (std::min(real.windows, rendered.windows) >= kFewestWindows)
    best = compared(false, real.force_N, real.force_spread_N, rendered.force_N, rendered.force_spread_N);
  if (std::min(real.releases, rendered.releases) >= kFewestReleases) {
    auto pull = compared(true, real.pull_N, real.pull_error_N, rendered.pull_N, rendered.pull_error_N);
    if (!same_motion) {
      constexpr double kBound = 0.5;  // a bound is two standard errors
      const GrowthBounds growth = growth_bounds(real.leaving_m_per_s / rendered.leaving_m_per_s, 0.0);
      const double bound_N = rendered.pull_N * (real.pull_N > rendered.pull_N ? growth.most : growth.least);
      pull.standard_error = std::hypot(pull.standard_error, kBound * std::abs(steps(bound_N) - steps(rendered.pull_N)));
    }
    if (!best.known || pull.jnd - pull.standard_error > best.jnd - best.standard_error) best = pull;
  }
  return best;
}

}  // namespace touchstone::perception
