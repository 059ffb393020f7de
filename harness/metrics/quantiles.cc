#include "harness/metrics/quantiles.h"

#include <cmath>

namespace touchstone::metrics {
namespace {

constexpr double gamma = (1.0 + Quantiles::relative_error) / (1.0 - Quantiles::relative_error);

}  // namespace

void Quantiles::add(double value) {
  static const double log_gamma = std::log(gamma);
  ++count_;
  if (value <= 0.0) {
    ++zeros_;
    return;
  }
  ++buckets_[static_cast<int>(std::ceil(std::log(value) / log_gamma))];
}

double Quantiles::quantile(double q) const {
  if (count_ == 0) return std::nan("");
  const auto rank = static_cast<std::uint64_t>(q * static_cast<double>(count_ - 1));
  std::uint64_t below = zeros_;
  if (rank < below) return 0.0;
  for (const auto& [bucket, held] : buckets_) {
    below += held;
    // The middle of the bucket in the sense of equal relative error to both ends.
    if (rank < below) return 2.0 * std::pow(gamma, bucket) / (gamma + 1.0);
  }
  return std::nan("");
}

}  // namespace touchstone::metrics
