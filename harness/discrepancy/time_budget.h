// How long a search may take, and what it left out for lack of time. For many threads.
#pragma once

#include <chrono>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace touchstone::discrepancy {

class TimeBudget {
 public:
  // From now on. Infinite: no limit.
  explicit TimeBudget(double limit_s) : limit_s_(limit_s), begin_(std::chrono::steady_clock::now()) {}

  [[nodiscard]] double limit_s() const { return limit_s_; }
  // Whether there is time to begin with `what`. If not, it is noted as not tried.
  bool allows(const std::string& what) {
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin_;
    if (taken.count() < limit_s_) return true;
    const std::lock_guard lock(mutex_);
    not_tried_.insert(what);
    return false;
  }
  [[nodiscard]] std::vector<std::string> not_tried() const {
    const std::lock_guard lock(mutex_);
    return {not_tried_.begin(), not_tried_.end()};
  }

 private:
  double limit_s_;
  std::chrono::steady_clock::time_point begin_;
  mutable std::mutex mutex_;
  std::set<std::string> not_tried_;
};

}  // namespace touchstone::discrepancy
