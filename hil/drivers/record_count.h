// A device's own count of its records, which wraps around, as a number that does not, with the losses counted; and the
// stamps of a clock that somebody sets meanwhile on one axis.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "devices/interfaces.h"

namespace touchstone::hil {

class RecordCount {
 public:
  // A record came that is `ahead` numbers after the one before it, at least 1; the first is number 0. Counts it, and
  // what is missing before it. Returns the flags that the sample deserves.
  std::uint32_t take(std::uint64_t ahead, StreamCounters& counters) {
    std::uint32_t flags = recording::sample_ok;
    if (started_) {
      sequence_ += ahead;
      counters.lost += ahead - 1;
      if (ahead > 1) flags |= recording::sample_after_gap;
    }
    started_ = true;
    ++counters.received;
    return flags;
  }
  [[nodiscard]] bool started() const noexcept { return started_; }
  [[nodiscard]] std::uint64_t sequence() const noexcept { return sequence_; }

 private:
  bool started_ = false;
  std::uint64_t sequence_ = 0;
};

// Of a device whose counter advances by an unknown step from one record to the next (a clock's ticks, camera frames of
// which every third is tracked): the shortest step that came is one record. Losses before the first undisturbed pair
// show when it comes, by earlier steps that are several of it.
class CountedSteps {
 public:
  // Records ahead by a step of the counter, with those that only now show to have been missing before.
  std::uint64_t ahead(std::uint32_t step) {
    std::uint64_t missed = 0;
    if (step > 0 && step < shortest_) {
      std::uint64_t before = 0, after = 0;
      for (const std::uint32_t earlier : early_) before += records_in(earlier);
      shortest_ = step;
      for (const std::uint32_t earlier : early_) after += records_in(earlier);
      missed = after - before;
    }
    if (early_.size() < most_early) early_.push_back(step);
    return records_in(step) + missed;
  }
  // The step of one record; 0: none came.
  [[nodiscard]] std::uint32_t shortest() const noexcept { return shortest_ == none ? 0 : shortest_; }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  // Steps from the start that are judged again when a shorter one comes: 10 s at 400 Hz. A line that loses records for
  // longer without one undisturbed pair is reported by its rate.
  static constexpr std::size_t most_early = 4000;

  [[nodiscard]] std::uint64_t records_in(std::uint32_t step) const {
    if (shortest_ == none) return 1;
    return static_cast<std::uint64_t>(std::max(1.0, std::round(static_cast<double>(step) / shortest_)));
  }

  std::uint32_t shortest_ = none;
  std::vector<std::uint32_t> early_;
};

// The stamps of a device's or a server's own clock, of records that come in their order. So a stamp that goes back is a
// clock that was set back. And a record cannot come sooner after the one before it than it was sent after it, but for
// what that one was late, with nothing in between: a stamp that runs ahead of the arrivals by more is a clock that was
// set forward. Across a step, which is counted, the arrivals bridge.
class DeviceStamps {
 public:
  explicit DeviceStamps(double ticks_per_s) : ticks_per_s_(ticks_per_s) {}

  void restart() noexcept { started_ = false, correction_ = 0; }
  [[nodiscard]] bool repeats(std::int64_t stamp) const noexcept { return started_ && stamp == last_; }
  // The stamp as it would be if nobody had set the clock since the first.
  std::uint64_t on_axis(std::int64_t stamp, double arrived_s, StreamCounters& counters) {
    constexpr double surely_s = 0.1;
    if (started_) {
      const double came = ticks_per_s_ * (arrived_s - arrived_s_), sent = static_cast<double>(stamp - last_);
      if (sent < 0.0 || sent > came + ticks_per_s_ * surely_s) {
        ++counters.clock_steps;
        correction_ += static_cast<std::int64_t>(std::max(1.0, came) - sent);
      }
    }
    started_ = true;
    last_ = stamp;
    arrived_s_ = arrived_s;
    return static_cast<std::uint64_t>(stamp + correction_);
  }

 private:
  double ticks_per_s_, arrived_s_ = 0.0;
  std::int64_t last_ = 0, correction_ = 0;
  bool started_ = false;
};

}  // namespace touchstone::hil
