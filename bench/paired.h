// Paired comparison of two series of times: run in turn, so that what slows the machine slows both.
// Wilcoxon's signed-rank test on the logarithms of the ratios, with the Hodges-Lehmann estimate of the ratio and its
// distribution-free interval (Hollander, Wolfe and Chicken 2014, sections 3.1 to 3.3). Both are exact: the null
// distribution is counted, not approximated.
#pragma once

#include <cstddef>
#include <span>

namespace touchstone::bench {

struct PairedComparison {
  std::size_t pairs = 0;
  double ratio = 1.0;  // of the second series to the first; below 1 is faster
  double low = 0.0;    // interval of the stated confidence; from 0 to infinity where so few pairs cannot give one
  double high = 0.0;
  double p = 1.0;  // two-sided, of no difference
};

// Both series have the same length, at least 1, and hold numbers above 0; throws std::invalid_argument otherwise.
PairedComparison compare_paired(std::span<const double> before, std::span<const double> after, double confidence);

}  // namespace touchstone::bench
