// Quantiles of values > 0 in bounded memory, with a stated error: each quantile is within a relative 0.1 % of a sample
// of that rank. Source: DDSketch (Masson, Rim and Lee, VLDB 2019), section 2: buckets of equal ratio
// gamma = (1 + alpha)/(1 - alpha), bucket i holds (gamma^(i-1), gamma^i].
#pragma once

#include <cstdint>
#include <map>

namespace touchstone::metrics {

class Quantiles {
 public:
  static constexpr double relative_error = 1e-3;

  // Values must be finite; those <= 0 count as exactly 0.
  void add(double value);
  [[nodiscard]] std::uint64_t count() const { return count_; }
  // The value of rank floor(q (count - 1)), 0 <= q <= 1, within relative_error; NaN without values.
  [[nodiscard]] double quantile(double q) const;

 private:
  std::uint64_t count_ = 0;
  std::uint64_t zeros_ = 0;
  // One entry per bucket in use: the whole range of double is at most 7e5 of them, times of steps are a few thousand.
  std::map<int, std::uint64_t> buckets_;
};

}  // namespace touchstone::metrics
