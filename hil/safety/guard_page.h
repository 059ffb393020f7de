// What the processes of a guard share besides their sockets: one page of atomics that outlives each of them, with the
// signs of life that they watch and the log of what happened.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "safety/force_supervisor.h"

namespace touchstone::hil {

enum class GuardPhase : std::uint8_t {
  opening,     // the driver opens the device
  at_zero,     // open; nothing is commanded
  pushing,     // a force is commanded
  letting_go,  // zero is repeated until the device confirms it
  rescue,      // the driver was ended; another process opens the device and brings it to zero
  off,         // zero is confirmed and the motors are off; stays
  unconfirmed  // zero was asked for in every way and is not confirmed yet: force may be on. Attempts go on
};
std::string_view to_string(GuardPhase phase);

struct GuardEvent {
  double t_s = 0.0;  // MonotonicClock
  GuardPhase phase = GuardPhase::opening;
  Trip reason = Trip::none;
  std::string what;
  std::uint64_t times = 1;  // that it happened in a row; t_s is the first
};

// The two that open the device anew if its driver does not bring it to zero. They take turns (rescue.h).
enum class Watchman : std::uint8_t { guard, rescuer };

class GuardPage {
 public:
  std::atomic<double> guard_beat_s{0.0};    // the guard's loop came round
  std::atomic<double> rescuer_beat_s{0.0};  // the rescuer's
  std::atomic<double> open_took_s{0.0};     // what the driver needed to open the device
  std::atomic<double> tripped_s{0.0};       // when the fault was seen
  std::atomic<double> zeroed_s{0.0};        // when zero was confirmed after it
  std::atomic<GuardPhase> phase{GuardPhase::opening};
  std::atomic<Trip> trip{Trip::none};
  std::atomic<bool> pushing{false};     // the guard let a force pass and has not yet seen it confirmed zero
  std::atomic<bool> device_zero{true};  // the last that the driver confirmed is zero
  std::atomic<bool> rescued{false};     // a process that opened the device anew confirmed zero
  std::atomic<Watchman> turn{Watchman::rescuer};
  std::atomic<int> attempts{0};  // to open the device anew
  std::atomic<int> guard_pid{0}, driver_pid{0}, rescuer_pid{0};

  [[nodiscard]] double beat_s(Watchman whose) const noexcept {
    return whose == Watchman::guard ? guard_beat_s : rescuer_beat_s;
  }
  // The first reason stays.
  void trip_for(Trip reason) noexcept {
    Trip none = Trip::none;
    trip.compare_exchange_strong(none, reason);
  }

  // Never waits. An event that repeats the last one is counted there. The first events stay for ever; of those after
  // them the oldest are overwritten. Texts are cut to 95 characters.
  void log(double t_s, GuardPhase at, Trip reason, const char* what) noexcept;
  [[nodiscard]] std::vector<GuardEvent> events() const;

 private:
  struct Slot {
    std::atomic<std::uint64_t> number{0};  // from 1; 0: empty or being written
    std::atomic<std::uint64_t> times{0};
    double t_s = 0.0;
    GuardPhase phase = GuardPhase::opening;
    Trip reason = Trip::none;
    char what[96] = {};
  };
  static constexpr std::uint64_t slots = 128, kept = 64;
  static constexpr std::uint64_t slot_of(std::uint64_t number) noexcept {
    return number <= kept ? number - 1 : kept + (number - kept - 1) % (slots - kept);
  }
  std::atomic<std::uint64_t> last_{0};
  Slot log_[slots];
};

// Memory that processes forked from here share; unmapped here when the last owner goes. Throws DeviceError if the
// system has none.
std::shared_ptr<GuardPage> make_guard_page();

// Whether this process may write to it. The program that is guarded may not: a stray pointer of a renderer must not
// tell the guard that no force is on.
void let_write(GuardPage& page, bool may) noexcept;

}  // namespace touchstone::hil
