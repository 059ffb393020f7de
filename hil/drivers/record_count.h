// A device's own count of its records, which wraps around, as a number that does not, with the losses counted.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hil/devices/interfaces.h"

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

}  // namespace touchstone::hil
