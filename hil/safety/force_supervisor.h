// What stands between a renderer and a motor: every force passes through here, and leaves limited or as zero.
//   Nothing before the device is calibrated and the dead-man input is held. Limits on force, slew, tip speed and
// workspace; a state or a command that is stale trips. A trip is latched: the force ramps down and stays zero until
// reset() is called with the reason acknowledged. The guard process runs one over every command (guardian.h); a servo
// loop may run its own with tighter limits. Allocates nothing and takes no lock: made for the servo loop.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "devices/interfaces.h"

namespace touchstone::hil {

// Time constant of the energy that is carried from contact to contact. A tap on a sampled wall of 1 kN/m gives some
// 1 mJ (guardian.h): ten taps a second for ever come to a tenth of a joule with it, five to half of that.
inline constexpr double energy_window_s = 10.0;

struct SafetyLimits {
  double force_N = 0.0;  // 0 allows nothing: a device without a limit in the hardware map is never driven
  double slew_N_per_s = 200.0;
  double speed_m_per_s = 1.0;
  Box3 workspace_W_m;  // empty: nowhere
  // What the device may give to the hand: at any moment, and net over one contact (from zero force to zero force) with
  // what the contacts before it gave. A passive rendering gives back at most what was put in (passivity observer:
  // Hannaford and Ryu 2002). What a contact gave is carried over to the next ones and forgotten over `energy_window_s`,
  // so that a wall that chatters, a little at each contact, adds up; what a contact took from the hand is set against
  // it, down to nothing: no credit is kept for later.
  double power_W = std::numeric_limits<double>::infinity();
  double energy_J = std::numeric_limits<double>::infinity();
  double temperature_C = std::numeric_limits<double>::infinity();  // of the motors, where it is read
  double stale_s = 0.02;                                           // a state or a command older than this trips
  double ramp_down_s = 0.1;                                        // from a trip to zero, never longer
};

enum class Trip : std::uint8_t {
  none,
  not_finite,
  force,
  speed,
  workspace,
  stale,
  dead_man,
  device_error,
  time_ran_back,
  asked,
  power,
  energy,
  temperature,
  client_gone,
  driver_silent,
  driver_gone,
  watchdog_gone,
  guard_gone,
  zero_not_confirmed
};
std::string_view to_string(Trip trip);

class ForceSupervisor {
 public:
  explicit ForceSupervisor(const SafetyLimits& limits) : limits_(limits) {}

  struct Input {
    double now_s = 0.0;
    DeviceState state;  // state.t_s tells its age
    Vec3 wanted_W_N = Vec3::Zero();
    bool calibrated = false;
    bool dead_man_held = false;
    bool device_error = false;
  };
  // The force to command now. A wanted force above the limit is cut to the limit (saturation is a renderer's normal
  // life); above twice the limit it trips (a renderer that has lost its mind).
  Vec3 allow(const Input& input) noexcept;

  // What is wrong with a state by itself, whatever is commanded.
  [[nodiscard]] Trip judge_state(const DeviceState& state, double now_s) const noexcept;

  void trip(Trip reason) noexcept;
  [[nodiscard]] Trip tripped() const noexcept { return trip_; }
  // The force is zero, brought there by others. Limits begin anew with the next force, but for the energy account.
  void rest(double now_s) noexcept;
  // Only with the reason that is latched: who resets must have read it.
  bool reset(Trip acknowledged) noexcept;
  [[nodiscard]] std::uint64_t saturated_steps() const noexcept { return saturated_; }

 private:
  [[nodiscard]] Trip judge(const Input& input) const noexcept;

  SafetyLimits limits_;
  Trip trip_ = Trip::none;
  double trip_s_ = 0.0;
  Vec3 at_trip_N_ = Vec3::Zero();
  bool trip_pending_ = false;
  bool started_ = false;
  double last_s_ = 0.0;
  Vec3 last_N_ = Vec3::Zero();
  void end_contact() noexcept;

  double given_J_ = 0.0;    // to the hand, since the force was zero
  double carried_J_ = 0.0;  // from the contacts before, at carried_s_
  double carried_s_ = 0.0;
  std::uint64_t saturated_ = 0;
};

// Zeroes the device when it goes out of scope. The inner of three guards: a crash, an uncaught exception, exit() and
// signals pass it by (see guardian.h and the device's own watchdog).
class ForceGuard {
 public:
  explicit ForceGuard(HapticDevice& device) : device_(device) {}
  ~ForceGuard() { device_.zero_force(); }
  ForceGuard(const ForceGuard&) = delete;
  ForceGuard& operator=(const ForceGuard&) = delete;

 private:
  HapticDevice& device_;
};

}  // namespace touchstone::hil
