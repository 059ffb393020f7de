#include "harness/perception/agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "harness/base/error.h"
#include "harness/stats/distributions.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
namespace {

constexpr std::size_t exact_up_to = 8;  // 8! = 40320 orders

void check_ranked(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 3) {
    throw BadData(fmt::format("a rank correlation needs two series of one length and at least 3 values, not {} and {}",
                              x.size(), y.size()));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      throw BadData(fmt::format("value {} of a rank correlation is not finite ({} and {})", i + 1, x[i], y[i]));
    }
  }
}

double pearson_of_ranks(const std::vector<double>& a, const std::vector<double>& b) {
  const double centre = 0.5 * (static_cast<double>(a.size()) + 1.0);
  double both = 0.0;
  double squares_a = 0.0;
  double squares_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += (a[i] - centre) * (b[i] - centre);
    squares_a += (a[i] - centre) * (a[i] - centre);
    squares_b += (b[i] - centre) * (b[i] - centre);
  }
  return both / std::sqrt(squares_a * squares_b);  // 0 / 0 is NaN for a constant series
}

double tau_b(const std::vector<double>& a, const std::vector<double>& b) {
  double score = 0.0;
  double pairs_a = 0.0;
  double pairs_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double da = a[i] > a[j] ? 1.0 : (a[i] < a[j] ? -1.0 : 0.0);
      const double db = b[i] > b[j] ? 1.0 : (b[i] < b[j] ? -1.0 : 0.0);
      score += da * db;
      pairs_a += da * da;
      pairs_b += db * db;
    }
  }
  return score / std::sqrt(pairs_a * pairs_b);
}

template <class Coefficient>
double exact_p(const std::vector<double>& a, std::vector<double> b, double observed, Coefficient coefficient) {
  std::sort(b.begin(), b.end());
  double extreme = 0.0;
  double all = 0.0;
  do {
    all += 1.0;
    if (std::abs(coefficient(a, b)) >= std::abs(observed) - 1e-12) extreme += 1.0;
  } while (std::next_permutation(b.begin(), b.end()));
  return extreme / all;
}

template <class Coefficient>
RankCorrelation correlate(std::span<const double> x, std::span<const double> y, Coefficient coefficient,
                          double (*z_variance)(double coefficient, double n), double (*null_variance)(double n)) {
  check_ranked(x, y);
  const auto a = stats::ranks(x);
  const auto b = stats::ranks(y);
  const auto n = static_cast<double>(x.size());
  RankCorrelation result;
  result.coefficient = std::clamp(coefficient(a, b), -1.0, 1.0);
  if (std::isnan(result.coefficient)) return result;
  const double variance = z_variance(result.coefficient, n);
  if (variance > 0.0 && std::isfinite(variance)) {
    const double reach = stats::normal_quantile(0.975) * std::sqrt(variance);
    const double z = std::atanh(result.coefficient);  // infinite at +-1: the interval is then that point
    result.low95 = std::tanh(z - reach);
    result.high95 = std::tanh(z + reach);
  }
  if (x.size() <= exact_up_to) {
    result.p_two_sided = exact_p(a, b, result.coefficient, coefficient);
  } else {
    result.p_two_sided = 2.0 * stats::normal_cdf(-std::abs(result.coefficient) / std::sqrt(null_variance(n)));
  }
  return result;
}

}  // namespace

RankCorrelation spearman(std::span<const double> x, std::span<const double> y) {
  return correlate(
      x, y, pearson_of_ranks, [](double rho, double n) { return (1.0 + 0.5 * rho * rho) / (n - 3.0); },
      [](double n) { return 1.0 / (n - 1.0); });
}

RankCorrelation kendall(std::span<const double> x, std::span<const double> y) {
  return correlate(
      x, y, tau_b, [](double, double n) { return 0.437 / (n - 4.0); },
      [](double n) { return 2.0 * (2.0 * n + 5.0) / (9.0 * n * (n - 1.0)); });
}

}  // namespace touchstone::perception
