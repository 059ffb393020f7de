// A clock for single steps of about 100 ns: the processor's time-stamp counter where there is one (its own cost is a
// few nanoseconds, known and subtracted), else steady_clock.
#pragma once

#include <chrono>
#include <cstdint>
#if defined(__x86_64__)
#include <x86intrin.h>

#endif

namespace touchstone::rendering {

class StepClock {
 public:
  // Measures tick length and the cost of reading the clock; takes about 5 ms.
  StepClock();

  static std::uint64_t ticks() noexcept {
#if defined(__x86_64__)
    unsigned int core = 0;
    // rdtscp waits for what came before it; the fence keeps what follows from starting early.
    const std::uint64_t now = __rdtscp(&core);
    _mm_lfence();
    return now;
#else
    return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
  }
  // The time between two readings without the cost of reading, never negative.
  [[nodiscard]] double elapsed_ns(std::uint64_t begin, std::uint64_t end) const noexcept {
    const double ns = static_cast<double>(end - begin) * ns_per_tick_ - overhead_ns_;
    return ns > 0.0 ? ns : 0.0;
  }
  [[nodiscard]] double overhead_ns() const noexcept { return overhead_ns_; }

 private:
  double ns_per_tick_ = 1.0;
  double overhead_ns_ = 0.0;
};

}  // namespace touchstone::rendering
