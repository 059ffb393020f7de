#include "harness/perception/distances/structural_similarity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"

namespace touchstone::perception {
namespace {

struct Moments {
  double mean_real, mean_rendered, variance_real, variance_rendered, covariance;
};

Moments moments(std::span<const double> x, std::span<const double> y) {
  Moments m{};
  const double share = 1.0 / static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    m.mean_real += x[i] * share;
    m.mean_rendered += y[i] * share;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = x[i] - m.mean_real;
    const double b = y[i] - m.mean_rendered;
    m.variance_real += a * a * share;
    m.variance_rendered += b * b * share;
    m.covariance += a * b * share;
  }
  return m;
}

// Both are zero where series and constants are: equal emptiness.
double ratio(double numerator, double denominator) { return denominator == 0.0 ? 1.0 : numerator / denominator; }

double power(double base, double exponent) {
  if (base < 0.0 && exponent != std::round(exponent)) return 0.0;
  return std::pow(base, exponent);
}

}  // namespace

double structural_similarity(std::span<const double> real, std::span<const double> rendered,
                             const StructuralSimilarityConstants& constants) {
  if (constants.window < 2 || constants.stride < 1) {
    throw UsageError("structural similarity needs windows of at least 2 samples and a stride of at least 1");
  }
  if (real.size() != rendered.size() || real.size() < constants.window) {
    throw BadData(
        fmt::format("structural similarity needs two series of one length and at least {} samples, not {} and {}",
                    constants.window, real.size(), rendered.size()));
  }
  const auto [low, high] = std::minmax_element(real.begin(), real.end());
  const double range = *high - *low;
  const double c1 = std::pow(constants.k1 * range, 2);
  const double c2 = std::pow(constants.k2 * range, 2);
  const double c3 = 0.5 * c2;
  double sum = 0.0;
  std::size_t windows = 0;
  for (std::size_t first = 0; first + constants.window <= real.size(); first += constants.stride) {
    const Moments m = moments(real.subspan(first, constants.window), rendered.subspan(first, constants.window));
    const double spread = std::sqrt(m.variance_real) * std::sqrt(m.variance_rendered);
    const double l = std::max(0.0, ratio(2.0 * m.mean_real * m.mean_rendered + c1,
                                         m.mean_real * m.mean_real + m.mean_rendered * m.mean_rendered + c1));
    const double c = ratio(2.0 * spread + c2, m.variance_real + m.variance_rendered + c2);
    const double s = ratio(m.covariance + c3, spread + c3);
    const double similarity = power(l, constants.alpha) * power(c, constants.beta) * power(s, constants.gamma);
    sum += power(similarity, constants.r);
    ++windows;
  }
  return sum / static_cast<double>(windows);
}

}  // namespace touchstone::perception
