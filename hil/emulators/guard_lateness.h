// Whether the machine was late, rather than the guard wrong: how long the processes around a guard (guardian.h) were
// ready to run and had no processor, and whether that explains that the guard let go. For tests of the guard: a trial
// is excused by a measured wait only, never because the guard's reason sounds like one.
//   Source of the waits: /proc/PID/schedstat, second number, nanoseconds on the run queue (Linux,
// Documentation/scheduler/sched-stats.rst). The kernel adds a wait when it ends; a process that sleeps or is stopped
// does not wait. What a hypervisor takes from a whole processor is in no process's wait: there the watcher, who has the
// highest priority of all, sees its own sleep end late.
#pragma once

#include <array>
#include <deque>
#include <memory>

#include "safety/guardian.h"

namespace touchstone::hil {

// Seconds without a processor, each since the process started or over a span. NaN: the kernel does not say.
struct GuardWaits {
  double program_s = 0.0, guard_s = 0.0, driver_s = 0.0, rescuer_s = 0.0;
  double watcher_s = 0.0;  // by which the watcher's own sleeps ended late; over a span: the worst of them

  // Of the guard's own processes together.
  [[nodiscard]] double processes_s() const { return guard_s + driver_s + rescuer_s; }
};

// Whether waits within `patience_of(reason)` before the guard let go for that reason are as long as the silence that it
// states: its patience, less what passes between two signs of life anyway. False for a reason that is no silence, for a
// process that ended, and where a wait that it rests on was not measured.
[[nodiscard]] bool explains(const GuardWaits& waits, Trip reason, const GuardOptions& options);
// The silence after which the guard or its rescuer lets go for that reason; 0: the reason is no silence.
[[nodiscard]] double patience_of(Trip reason, const GuardOptions& options);
// What passes at most between two commands or two beats of the guard without any lateness.
inline constexpr double usual_silence_s = 0.002;

// Watches the processes of one guard from outside. Called again and again by a watcher of higher priority than theirs.
class GuardLateness {
 public:
  // `page` outlives this. The program by its number, the others as soon as the page names them.
  GuardLateness(int program_pid, const GuardPage& page);
  ~GuardLateness();
  GuardLateness(const GuardLateness&) = delete;
  GuardLateness& operator=(const GuardLateness&) = delete;

  // The watcher's sleep was due then and is over now.
  void look(double due_s);
  // What they waited from then (or from the last look before) to the last look.
  [[nodiscard]] GuardWaits since(double t_s) const;

 private:
  struct Look {
    double t_s = 0.0;
    std::array<double, 4> total_s{};
    double watcher_s = 0.0;
  };
  [[nodiscard]] double total_s(std::size_t process);

  const GuardPage& page_;
  int program_pid_;
  std::array<int, 4> files_;
  std::array<double, 4> last_s_;
  std::deque<Look> looks_;
  MonotonicClock clock_;
};

}  // namespace touchstone::hil
