// How late this machine lets a thread run, measured while a test runs: a thread that asks to be woken each millisecond.
// A limit in time holds for the code; what the machine adds is measured, not guessed.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>

#include "devices/interfaces.h"

namespace touchstone::hil {

class SchedulingLateness {
 public:
  SchedulingLateness() {
    thread_ = std::thread([this] {
      MonotonicClock clock;
      while (!stop_) {
        const double due = clock.now_s() + 1e-3;
        clock.sleep_until(due);
        worst_s_ = std::max(worst_s_.load(), clock.now_s() - due);
      }
    });
  }
  ~SchedulingLateness() {
    stop_ = true;
    thread_.join();
  }
  SchedulingLateness(const SchedulingLateness&) = delete;
  SchedulingLateness& operator=(const SchedulingLateness&) = delete;

  [[nodiscard]] double worst_s() const noexcept { return worst_s_; }

 private:
  std::atomic<double> worst_s_{0.0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace touchstone::hil
