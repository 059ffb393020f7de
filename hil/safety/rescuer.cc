#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <ctime>

#include "hil/safety/guard_processes.h"
#include "hil/safety/harden.h"

namespace touchstone::hil {
namespace {

constexpr int rescuer_priority = 82;        // above those that it watches
constexpr double look_s = 0.001;            // while a force is on
constexpr double look_idle_s = 0.005;       // a force that comes on meanwhile is seen before watchdog_s has passed
constexpr double driver_lets_go_s = 0.004;  // what a living driver needs to see that its guard is gone
constexpr double first_attempt_s = 0.05;    // a device that opens at once; longer each time
constexpr double longest_attempt_s = 5.0, gives_up_s = 60.0;

// A process by a handle that no other process can inherit with its number.
class ProcessHandle {
 public:
  explicit ProcessHandle(pid_t pid) : fd_(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0U))) {}
  ~ProcessHandle() {
    if (fd_ >= 0) ::close(fd_);
  }
  ProcessHandle(const ProcessHandle&) = delete;
  ProcessHandle& operator=(const ProcessHandle&) = delete;
  void kill() const noexcept {
    if (fd_ >= 0) ::syscall(SYS_pidfd_send_signal, fd_, SIGKILL, nullptr, 0U);
  }

 private:
  int fd_;
};

class Rescuer {
 public:
  Rescuer(int guard_pipe, const OpenDevice& open, const GuardOptions& options, GuardPage& page)
      : pipe_(guard_pipe),
        open_(open),
        options_(options),
        page_(page),
        guard_(page.guard_pid),
        driver_(page.driver_pid) {}

  int watch() {
    for (;;) {
      const bool pushing = page_.pushing;
      const timespec wait{0, static_cast<long>((pushing ? look_s : look_idle_s) * 1e9)};
      pollfd ready{pipe_, POLLIN, 0};
      const int n = ::ppoll(&ready, 1, &wait, nullptr);
      if (n > 0) {
        char word = 0;
        const auto got = ::read(pipe_, &word, 1);
        if (got == 1 && word == rescuer_end) return 0;
        if (got == 1 && word == rescuer_rescue) {
          driver_.kill();
          rescue(page_.trip);
          continue;
        }
        if (got <= 0) return guard_is_gone();
      }
      if (page_.pushing && clock_.now_s() - page_.guard_beat_s > options_.watchdog_s) {
        note(GuardPhase::rescue, Trip::guard_gone, "the guard shows no sign of life");
        guard_.kill();
        driver_.kill();
        rescue(Trip::guard_gone);
        return 0;
      }
    }
  }

 private:
  int guard_is_gone() {
    if (page_.device_zero && !page_.pushing) return 0;
    // The driver sees the same and lets go by itself where it can.
    page_.trip = Trip::guard_gone;
    const double until = clock_.now_s() + driver_lets_go_s;
    while (!page_.device_zero && clock_.now_s() < until) clock_.sleep_until(clock_.now_s() + 0.0005);
    if (page_.device_zero) {
      page_.pushing = false;
      note(GuardPhase::off, Trip::guard_gone, "the guard is gone; the driver brought the device to zero");
      return 0;
    }
    note(GuardPhase::rescue, Trip::guard_gone, "the guard is gone and the driver does not let go");
    driver_.kill();
    rescue(Trip::guard_gone);
    return 0;
  }

  // Each attempt is a process of its own, so that a call that blocks costs that process only.
  void rescue(Trip reason) {
    page_.trip = reason;
    const double give_up = clock_.now_s() + gives_up_s;
    for (double patience = first_attempt_s; clock_.now_s() < give_up;
         patience = std::min(longest_attempt_s, 2.0 * patience)) {
      const pid_t attempt = ::fork();
      if (attempt == 0) ::_exit(bring_to_rest_anew(clock_.now_s() + patience) ? 0 : 1);
      if (attempt < 0) continue;
      if (ends_well(attempt, clock_.now_s() + patience)) {
        page_.device_zero = true;
        page_.pushing = false;
        page_.zeroed_s = clock_.now_s();
        page_.rescued = true;
        note(GuardPhase::off, reason, "the rescuer opened the device anew and it confirmed zero");
        return;
      }
      note(GuardPhase::rescue, reason, "an attempt to bring the device to zero failed");
    }
    note(GuardPhase::unconfirmed, Trip::zero_not_confirmed, "the rescuer gave up: use the physical switch");
  }

  bool bring_to_rest_anew(double deadline_s) const noexcept {
    try {
      const auto device = open_();
      return bring_to_rest(*device, deadline_s);
    } catch (...) {
      return false;
    }
  }

  static bool ends_well(pid_t child, double deadline_s) {
    MonotonicClock clock;
    for (;;) {
      int status = 0;
      const pid_t ended = ::waitpid(child, &status, WNOHANG);
      if (ended == child) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
      if (ended < 0) return false;
      if (clock.now_s() > deadline_s) {
        ::kill(child, SIGKILL);  // still our own child: the number cannot be another's
        ::waitpid(child, nullptr, 0);
        return false;
      }
      clock.sleep_until(clock.now_s() + 0.0002);
    }
  }

  void note(GuardPhase phase, Trip reason, const char* what) {
    page_.phase = phase;
    page_.log(clock_.now_s(), phase, reason, what);
  }

  int pipe_;
  const OpenDevice& open_;
  const GuardOptions& options_;
  GuardPage& page_;
  ProcessHandle guard_, driver_;
  mutable MonotonicClock clock_;
};

}  // namespace

int run_rescuer(int guard, const OpenDevice& open, const GuardOptions& options, GuardPage& page) {
  const auto missing = harden(rescuer_priority, LockedMemory::also_future);
  if (!missing.empty())
    page.log(MonotonicClock().now_s(), GuardPhase::opening, Trip::none, ("rescuer without " + missing).c_str());
  return Rescuer(guard, open, options, page).watch();
}

}  // namespace touchstone::hil
