#include "harness/rendering/step_clock.h"

#include <algorithm>
#include <array>

namespace touchstone::rendering {

StepClock::StepClock() {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const auto first = ticks();
  std::array<std::uint64_t, 1001> reads{};
  for (auto& read : reads) {
    const auto before = ticks();
    read = ticks() - before;
  }
  std::nth_element(reads.begin(), reads.begin() + 500, reads.end());
  while (Clock::now() - began < std::chrono::milliseconds(5)) {
  }
  const auto last = ticks();
  const double ns = std::chrono::duration<double, std::nano>(Clock::now() - began).count();
  ns_per_tick_ = ns / static_cast<double>(last - first);
  overhead_ns_ = static_cast<double>(reads[500]) * ns_per_tick_;
}

}  // namespace touchstone::rendering
