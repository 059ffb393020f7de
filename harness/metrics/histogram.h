// A histogram of values >= 0 whose range is not known beforehand, in bounded memory: when a value lies beyond the last
// bin, neighbouring bins are merged and the width doubles. Counts are exact at every length.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace touchstone::metrics {

struct Histogram {
  std::string unit;
  double width = 0.0;                 // bin i is [i width, (i + 1) width); 0 when there is no positive value
  std::vector<std::uint64_t> counts;  // up to the last bin that is not empty

  [[nodiscard]] std::uint64_t total() const;
};

class HistogramRecorder {
 public:
  static constexpr std::size_t bins = 256;

  explicit HistogramRecorder(std::string unit) : unit_(std::move(unit)) {}

  // Values that are not finite or below 0 are left out (the metrics that own a histogram are invalid then).
  void add(double value);
  [[nodiscard]] Histogram histogram() const;

 private:
  std::string unit_;
  double width_ = 0.0;
  std::uint64_t zeros_ = 0;  // zeros seen before the first positive value chose a width
  std::vector<std::uint64_t> counts_;
};

}  // namespace touchstone::metrics
