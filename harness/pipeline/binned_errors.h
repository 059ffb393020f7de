// The squared force errors of one renderer on one recording, summed over short bins of time: small enough to keep for
// many renderers, fine enough for every resampling of blocks of time (ranking.h).
#pragma once

#include <cstdint>
#include <vector>

namespace touchstone::pipeline {

inline constexpr double error_bin_s = 0.1;

struct BinnedErrors {
  std::vector<double> squares_N2;      // sum of |f_rendered - f_measured|^2 by bin
  std::vector<std::uint64_t> samples;  // by bin; bins without samples (a gap, a held-out range) are left out

  [[nodiscard]] std::size_t size() const noexcept { return samples.size(); }
  [[nodiscard]] double rms_N() const;  // over all samples; NaN without any
};

// Takes the samples in the order of time.
class ErrorBinner {
 public:
  explicit ErrorBinner(double bin_s = error_bin_s) : bin_s_(bin_s) {}
  void add(double t_s, double squared_N2);
  [[nodiscard]] const BinnedErrors& errors() const noexcept { return errors_; }

 private:
  double bin_s_;
  double first_t_s_ = 0.0;
  std::int64_t bin_ = -1;
  BinnedErrors errors_;
};

}  // namespace touchstone::pipeline
