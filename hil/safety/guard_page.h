// What the processes of a guard share besides their sockets: one page of atomics that outlives each of them, with the
// signs of life that they watch and the log of what happened.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "hil/safety/force_supervisor.h"

namespace touchstone::hil {

enum class GuardPhase : std::uint8_t {
  opening,     // the driver opens the device
  at_zero,     // open; nothing is commanded
  pushing,     // a force is commanded
  letting_go,  // zero is repeated until the device confirms it
  rescue,      // the driver was ended; another process opens the device and brings it to zero
  off,         // zero is confirmed and the motors are off; stays
  unconfirmed  // zero was asked for in every way and the device did not confirm: only the physical switch is left
};
std::string_view to_string(GuardPhase phase);

struct GuardEvent {
  double t_s = 0.0;  // MonotonicClock
  GuardPhase phase = GuardPhase::opening;
  Trip reason = Trip::none;
  std::string what;
};

class GuardPage {
 public:
  std::atomic<double> guard_beat_s{0.0};  // the guard's loop came round
  std::atomic<double> tripped_s{0.0};     // when the fault was seen
  std::atomic<double> zeroed_s{0.0};      // when zero was confirmed after it
  std::atomic<GuardPhase> phase{GuardPhase::opening};
  std::atomic<Trip> trip{Trip::none};
  std::atomic<bool> pushing{false};     // the guard let a force pass and has not yet seen it confirmed zero
  std::atomic<bool> device_zero{true};  // the last that the driver confirmed is zero
  std::atomic<bool> rescued{false};     // the rescuer confirmed zero
  std::atomic<int> guard_pid{0}, driver_pid{0}, rescuer_pid{0};

  // Never waits; the oldest events are overwritten. Texts are cut to 95 characters.
  void log(double t_s, GuardPhase at, Trip reason, const char* what) noexcept;
  [[nodiscard]] std::vector<GuardEvent> events() const;

 private:
  struct Slot {
    std::atomic<std::uint64_t> number{0};  // from 1; 0: empty or being written
    double t_s = 0.0;
    GuardPhase phase = GuardPhase::opening;
    Trip reason = Trip::none;
    char what[96] = {};
  };
  static constexpr std::size_t slots = 128;
  std::atomic<std::uint64_t> next_{0};
  Slot log_[slots];
};

// Memory that processes forked from here share; unmapped here when the last owner goes. Throws DeviceError if the
// system has none.
std::shared_ptr<GuardPage> make_guard_page();

}  // namespace touchstone::hil
