// Sums that stay exact to rounding over ten million samples, and that remember what was not finite.
// Source: Neumaier's compensated summation (ZAMM 54, 1974).
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

namespace touchstone::metrics {

class CompensatedSum {
 public:
  void add(double value) {
    const double next = sum_ + value;
    carry_ += std::abs(sum_) >= std::abs(value) ? (sum_ - next) + value : (value - next) + sum_;
    sum_ = next;
  }
  [[nodiscard]] double value() const { return sum_ + carry_; }

 private:
  double sum_ = 0.0;
  double carry_ = 0.0;
};

// Count, mean, root mean square, largest magnitude and when, of one signal.
class Moments {
 public:
  void add(double t_s, double value) {
    ++count_;
    if (!std::isfinite(value)) {
      if (bad_++ == 0) first_bad_t_s_ = t_s;
      return;
    }
    sum_.add(value);
    squares_.add(value * value);
    if (count_ - bad_ == 1 || std::abs(value) > std::abs(peak_)) peak_ = value, peak_t_s_ = t_s;
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::uint64_t bad() const { return bad_; }
  [[nodiscard]] double first_bad_t_s() const { return first_bad_t_s_; }
  // NaN without samples, or with one that was not finite.
  [[nodiscard]] double mean() const { return usable() ? sum_.value() / static_cast<double>(count_) : std::nan(""); }
  [[nodiscard]] double rms() const {
    return usable() ? std::sqrt(squares_.value() / static_cast<double>(count_)) : std::nan("");
  }
  [[nodiscard]] double peak() const { return usable() ? peak_ : std::nan(""); }  // signed value of largest magnitude
  [[nodiscard]] double peak_t_s() const { return peak_t_s_; }

 private:
  [[nodiscard]] bool usable() const { return count_ > 0 && bad_ == 0; }

  std::uint64_t count_ = 0;
  std::uint64_t bad_ = 0;
  double first_bad_t_s_ = 0.0;
  CompensatedSum sum_;
  CompensatedSum squares_;
  double peak_ = 0.0;
  double peak_t_s_ = 0.0;
};

}  // namespace touchstone::metrics
