#include "harness/metrics/histogram.h"

#include <cmath>
#include <numeric>

namespace touchstone::metrics {

std::uint64_t Histogram::total() const { return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}); }

void HistogramRecorder::add(double value) {
  if (!std::isfinite(value) || value < 0.0) return;
  if (width_ == 0.0) {
    if (value == 0.0) {
      ++zeros_;
      return;
    }
    // A power of two, so that merging pairs and doubling the width are exact.
    width_ = 2.0 * std::exp2(std::floor(std::log2(value))) / static_cast<double>(bins);
    if (width_ == 0.0) width_ = std::numeric_limits<double>::min();
    counts_.assign(bins, 0);
    counts_[0] = zeros_;
  }
  while (value >= width_ * static_cast<double>(bins)) {
    for (std::size_t i = 0; i < bins / 2; ++i) counts_[i] = counts_[2 * i] + counts_[2 * i + 1];
    for (std::size_t i = bins / 2; i < bins; ++i) counts_[i] = 0;
    width_ *= 2.0;
  }
  ++counts_[static_cast<std::size_t>(value / width_)];
}

Histogram HistogramRecorder::histogram() const {
  Histogram out{unit_, width_, counts_};
  if (width_ == 0.0 && zeros_ > 0) out.counts = {zeros_};
  while (!out.counts.empty() && out.counts.back() == 0) out.counts.pop_back();
  return out;
}

}  // namespace touchstone::metrics
