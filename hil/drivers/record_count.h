// A device's own count of its records, which wraps around, as a number that does not, with the losses counted.
#pragma once

#include <cstdint>

#include "harness/base/rooms.h"
#include "hil/devices/interfaces.h"

namespace touchstone::hil {

class RecordCount {
 public:
  // A record came that is `ahead` numbers after the one before it, at least 1; the first is number 0. Counts it, and
  // what is missing before it. Returns the flags that the sample deserves.
  std::uint32_t take(std::uint64_t ahead, StreamCounters& counters) {
    std::uint32_t flags = sample_ok;
    if (started_) {
      sequence_ += ahead;
      counters.lost += ahead - 1;
      if (ahead > 1) flags |= sample_after_gap;
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

}  // namespace touchstone::hil
