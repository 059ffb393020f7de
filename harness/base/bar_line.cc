#include "harness/base/bar_line.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone {

std::string bar_line(std::span<const double> values, double low, double high) {
  static constexpr std::array blocks{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  std::string line;
  for (const double value : values) {
    const double share = high > low ? std::clamp((value - low) / (high - low), 0.0, 1.0) : 0.0;
    constexpr double levels = 8.99;  // the last of nine at the highest value itself
    line += blocks[std::isfinite(share) ? static_cast<std::size_t>(levels * share) : 0];
  }
  return line;
}

}  // namespace touchstone
