#include "harness/perception/distances/signal_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
namespace {

void check_lengths(std::span<const double> real, std::span<const double> rendered) {
  if (real.empty() || real.size() != rendered.size()) {
    throw BadData(fmt::format("series of {} and {} values cannot be compared sample by sample; resample them first",
                              real.size(), rendered.size()));
  }
}

double largest_magnitude(std::span<const double> x) {
  double result = 0.0;
  for (const double value : x) result = std::max(result, std::abs(value));
  return result;
}

// But for rounding. Not by the spread about the mean: that of a long series is rounded itself.
bool constant(std::span<const double> x) {
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  return *high - *low <= 16.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(*low), std::abs(*high));
}

}  // namespace

double euclidean_distance(std::span<const double> real, std::span<const double> rendered) {
  return std::sqrt(mean_square_error(real, rendered) * static_cast<double>(real.size()));
}

double mean_square_error(std::span<const double> real, std::span<const double> rendered) {
  check_lengths(real, rendered);
  double sum = 0.0;
  for (std::size_t i = 0; i < real.size(); ++i) sum += (real[i] - rendered[i]) * (real[i] - rendered[i]);
  return sum / static_cast<double>(real.size());
}

std::optional<double> pearson_correlation(std::span<const double> real, std::span<const double> rendered) {
  check_lengths(real, rendered);
  const double real_mean = stats::mean(real);
  const double rendered_mean = stats::mean(rendered);
  double both = 0.0;
  double squares_real = 0.0;
  double squares_rendered = 0.0;
  for (std::size_t i = 0; i < real.size(); ++i) {
    const double a = real[i] - real_mean;
    const double b = rendered[i] - rendered_mean;
    both += a * b;
    squares_real += a * a;
    squares_rendered += b * b;
  }
  if (constant(real) || constant(rendered)) return std::nullopt;
  return std::clamp(both / (std::sqrt(squares_real) * std::sqrt(squares_rendered)), -1.0, 1.0);
}

double maximum_absolute_error(std::span<const double> real, std::span<const double> rendered) {
  check_lengths(real, rendered);
  double result = 0.0;
  for (std::size_t i = 0; i < real.size(); ++i) result = std::max(result, std::abs(real[i] - rendered[i]));
  return result;
}

double peak_difference(std::span<const double> real, std::span<const double> rendered) {
  check_lengths(real, rendered);
  return largest_magnitude(rendered) - largest_magnitude(real);
}

std::vector<double> noticeable_steps(std::span<const double> stimulus, const WeberLaw& law) {
  std::vector<double> result(stimulus.size());
  std::transform(stimulus.begin(), stimulus.end(), result.begin(), NoticeableSteps(law));
  return result;
}

double perceptual_mean_square_error(std::span<const double> real, std::span<const double> rendered,
                                    const WeberLaw& law) {
  check_lengths(real, rendered);
  return mean_square_error(noticeable_steps(real, law), noticeable_steps(rendered, law));
}

}  // namespace touchstone::perception
