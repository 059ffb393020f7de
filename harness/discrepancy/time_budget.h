// How long a search and its answer may take together, and what was left out for lack of time. For many threads.
//
// A limit is kept by what is not begun: what the answer needs at the end cannot be cut, so that the search stops as
// much earlier as that takes. How long it takes is taken from the reading of the recordings, which it does a second
// time.
#pragma once

#include <chrono>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace touchstone::discrepancy {

class TimeBudget {
 public:
  using Clock = std::chrono::steady_clock;

  // Infinite: no limit. `checks_s`: of it, what the checks and pages of the answer need at the end.
  explicit TimeBudget(double limit_s, Clock::time_point begin = Clock::now(), double checks_s = 0.0)
      : limit_s_(limit_s), checks_s_(checks_s), begin_(begin) {}

  [[nodiscard]] double limit_s() const { return limit_s_; }
  // Whether there is time to begin with `what`. If not, it is noted as not tried.
  bool allows(const std::string& what) {
    if (taken_s() < limit_s_ - kept_s()) return true;
    const std::lock_guard lock(mutex_);
    not_tried_.insert(what);
    return false;
  }
  // The search is over: what was kept back for the values and their intervals may be taken. Nobody else may ask
  // meanwhile.
  void turn_to_values() { searching_ = false; }
  [[nodiscard]] std::vector<std::string> not_tried() const {
    const std::lock_guard lock(mutex_);
    return {not_tried_.begin(), not_tried_.end()};
  }

 private:
  [[nodiscard]] double taken_s() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  // Values and intervals are a few hundred predictions, as the checks are.
  [[nodiscard]] double kept_s() const { return searching_ ? 2.0 * checks_s_ : checks_s_; }

  double limit_s_;
  double checks_s_;
  Clock::time_point begin_;
  bool searching_ = true;
  mutable std::mutex mutex_;
  std::set<std::string> not_tried_;
};

}  // namespace touchstone::discrepancy
