#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <ctime>

#include "safety/guard_processes.h"
#include "safety/harden.h"
#include "safety/rescue.h"

namespace touchstone::hil {
namespace {

constexpr int rescuer_priority = 82;        // above those that it watches
constexpr double look_s = 0.001;            // while a force is on
constexpr double look_idle_s = 0.002;       // a force that comes on meanwhile is seen before watchdog_s has passed
constexpr double ending_s = 0.01;           // the system needs up to 7 ms to end a process that was killed
constexpr double driver_lets_go_s = 0.004;  // what a living driver needs to see that its guard is gone
constexpr double between_steps_s = 3e-4;    // of a rescue
class Rescuer {
 public:
  Rescuer(int guard_pipe, const OpenDevice& open, const GuardOptions& options, GuardPage& page)
      : pipe_(guard_pipe),
        options_(options),
        page_(page),
        guard_(page.guard_pid),
        driver_(page.driver_pid),
        rescue_(Watchman::rescuer, open, page, options.watchdog_s) {}

  int watch() {
    for (;;) {
      beat();
      const bool pushing = page_.pushing;
      const timespec wait{0, static_cast<long>((pushing ? look_s : look_idle_s) * 1e9)};
      pollfd ready{pipe_, POLLIN, 0};
      const int n = ::ppoll(&ready, 1, &wait, nullptr);
      beat();
      if (n > 0) {
        char word = 0;
        const auto got = ::read(pipe_, &word, 1);
        if (got == 1 && word == rescuer_end) return 0;
        if (got == 1 && word == rescuer_rescue) {
          end_driver();
          rescue(page_.trip);
          continue;
        }
        if (got <= 0) return guard_is_gone();
      }
      if (page_.pushing && clock_.now_s() - page_.guard_beat_s > options_.watchdog_s) {
        note(GuardPhase::rescue, Trip::guard_gone, "the guard shows no sign of life");
        end_driver();  // first: its parent, the guard, lets the kernel forget it at once
        guard_.kill();
        rescue(Trip::guard_gone);
        return 0;
      }
    }
  }

 private:
  void beat() { page_.rescuer_beat_s = clock_.now_s(); }

  int guard_is_gone() {
    if (page_.device_zero && !page_.pushing) return 0;
    // The driver sees the same and lets go by itself where it can.
    page_.trip_for(Trip::guard_gone);
    const double until = clock_.now_s() + driver_lets_go_s;
    while (!page_.device_zero && clock_.now_s() < until) clock_.sleep_until(clock_.now_s() + 0.0005);
    if (page_.device_zero) {
      page_.pushing = false;
      note(GuardPhase::off, Trip::guard_gone, "the guard is gone; the driver brought the device to zero");
      return 0;
    }
    note(GuardPhase::rescue, Trip::guard_gone, "the guard is gone and the driver does not let go");
    end_driver();
    rescue(Trip::guard_gone);
    return 0;
  }

  // A device that is locked by its owner's number opens once the kernel has forgotten the owner.
  void end_driver() const {
    driver_.kill();
    static_cast<void>(driver_.ends_within(ending_s));
  }

  void rescue(Trip reason) {
    rescue_.begin(reason);
    for (beat(); !rescue_.step(); beat()) clock_.sleep_until(clock_.now_s() + between_steps_s);
  }

  void note(GuardPhase phase, Trip reason, const char* what) {
    page_.phase = phase;
    page_.log(clock_.now_s(), phase, reason, what);
  }

  int pipe_;
  const GuardOptions& options_;
  GuardPage& page_;
  ProcessHandle guard_, driver_;
  Rescue rescue_;
  MonotonicClock clock_;
};

}  // namespace

int run_rescuer(int guard, const OpenDevice& open, const GuardOptions& options, GuardPage& page) {
  const auto missing = harden(rescuer_priority, LockedMemory::also_future);
  if (!missing.empty())
    page.log(MonotonicClock().now_s(), GuardPhase::opening, Trip::none, ("rescuer without " + missing).c_str());
  return Rescuer(guard, open, options, page).watch();
}

}  // namespace touchstone::hil
