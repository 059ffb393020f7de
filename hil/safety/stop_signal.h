// Ctrl-C and SIGTERM as a question that the servo loop asks, so that it leaves by its own return and every guard runs.
#pragma once

#include <csignal>

namespace touchstone::hil {

// Blocks SIGINT, SIGTERM and SIGHUP for the calling thread and those it starts later; restores them when it goes.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // True once one of them has come. Does not wait.
  bool asked() noexcept;

 private:
  sigset_t watched_{};
  sigset_t before_{};
  bool asked_ = false;
};

}  // namespace touchstone::hil
