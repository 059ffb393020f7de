// Quantiles of step times in bounded memory: a histogram whose buckets are 1/128 wide relative to their value, so that
// every quantile is right to 0.4 % however many steps there are. No allocation after construction.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace touchstone::rendering {

class CostHistogram {
 public:
  void add(double ns) noexcept {
    ++count_;
    if (!(ns > 0.0)) ns = 0.0;
    sum_ns_ += ns;
    if (ns > max_ns_) max_ns_ = ns;
    ++buckets_[bucket(ns)];
  }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double mean_ns() const noexcept {
    return count_ > 0 ? sum_ns_ / static_cast<double>(count_) : std::nan("");
  }
  [[nodiscard]] double max_ns() const noexcept { return count_ > 0 ? max_ns_ : std::nan(""); }
  // The smallest value that at least the fraction `q` of the steps does not exceed (nearest rank); NaN without steps.
  [[nodiscard]] double quantile_ns(double q) const noexcept {
    if (count_ == 0) return std::nan("");
    const double rank = q * static_cast<double>(count_);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < buckets_.size(); ++i) {
      seen += buckets_[i];
      if (static_cast<double>(seen) >= rank && seen > 0) return std::fmin(value(i), max_ns_);
    }
    return max_ns_;
  }

 private:
  static constexpr int per_octave = 128;
  static constexpr int octaves = 40;  // 1 ns to 18 minutes
  // Octave from the exponent, then linear within it.
  static std::size_t bucket(double ns) noexcept {
    if (ns < 1.0) return 0;
    int exponent = 0;
    const double mantissa = std::frexp(ns, &exponent);  // in [0.5, 1)
    const int index = 1 + (exponent - 1) * per_octave + static_cast<int>((mantissa - 0.5) * 2 * per_octave);
    return index < per_octave * octaves ? static_cast<std::size_t>(index)
                                        : static_cast<std::size_t>(per_octave * octaves);
  }
  static double value(std::size_t index) noexcept {
    if (index == 0) return 0.5;
    const auto octave = static_cast<int>((index - 1) / per_octave);
    const auto step = static_cast<double>((index - 1) % per_octave) + 0.5;
    return std::ldexp(1.0 + step / per_octave, octave);
  }

  std::array<std::uint64_t, per_octave * octaves + 1> buckets_{};
  std::uint64_t count_ = 0;
  double sum_ns_ = 0.0;
  double max_ns_ = 0.0;
};

}  // namespace touchstone::rendering
