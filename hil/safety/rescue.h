// Brings a device to zero whose driver is gone or does not obey: opens it anew, each time in a process of its own, so
// that a call that blocks costs that process only. Guard and rescuer both can. They take turns, since a device may
// refuse two that open it at once; a turn passes with each attempt that fails, and at once if the other shows no sign
// of life. An attempt may take twice as long as the driver needed to open the device, so that none is cut off in the
// middle of opening; later ones may take longer. Attempts never end before zero is confirmed, but for `gives_up_s`.
#pragma once

#include <sys/types.h>

#include "safety/guard_processes.h"

namespace touchstone::hil {

// A process by a handle that no other process can inherit with its number.
class ProcessHandle {
 public:
  explicit ProcessHandle(pid_t pid);
  ~ProcessHandle();
  ProcessHandle(const ProcessHandle&) = delete;
  ProcessHandle& operator=(const ProcessHandle&) = delete;
  void kill() const noexcept;
  // Waits for its end, at most so long. True if it has ended.
  [[nodiscard]] bool ends_within(double seconds) const noexcept;

 private:
  int fd_;
};

class Rescue {
 public:
  // `other_silent_s`: the age of the other watchman's last beat from which on it does not count any more.
  Rescue(Watchman self, const OpenDevice& open, GuardPage& page, double other_silent_s);

  // The driver was ended by the caller.
  void begin(Trip reason) noexcept;
  [[nodiscard]] bool begun() const noexcept { return begun_s_ > 0.0; }
  // Starts, watches and ends attempts; never waits. False while there is more to do: call it again within a
  // millisecond.
  bool step() noexcept;

 private:
  void start(double now_s) noexcept;
  void failed(double now_s, const char* what) noexcept;
  void note(GuardPhase phase, const char* what) noexcept;
  // In the process of an attempt.
  [[nodiscard]] bool bring_to_rest_anew(double deadline_s) const noexcept;

  Watchman self_, other_;
  const OpenDevice& open_;
  GuardPage& page_;
  double other_silent_s_;
  Trip reason_ = Trip::none;
  double begun_s_ = 0.0, turn_s_ = 0.0, longest_s_ = 0.0, turn_ends_s_ = 0.0, deadline_s_ = 0.0, not_before_s_ = 0.0;
  bool no_process_ = false;  // the last attempt could not be started
  pid_t attempt_ = 0;
  MonotonicClock clock_;
};

}  // namespace touchstone::hil
