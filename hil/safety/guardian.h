// The outer guard. No program that computes forces holds the device: it asks a guard, and the limits are the guard's.
//
//   program --socket--> guard --socket--> driver process (owns the device)
//                         |                     ^
//                         +---- rescuer --------+   (watches both, ends them, brings the device to zero itself)
//
// One rule: while any of guard, driver, rescuer or, waiting for an answer, the program lives, the force ends. Each
// watches the others' signs of life, not their sockets alone: a process that is stopped is as good as dead.
//
//   guard    a process of its own, real-time, memory locked, protected from the out-of-memory killer where the user
//            may. Every command passes its ForceSupervisor: force, force rate, speed, workspace, power, energy,
//            temperature, NaN, age. It calls no device code, so that no driver can stop it. On a trip, or when the
//            program falls silent or ends in any way, it has zero repeated until the device confirms it, then the
//            motors switched off. A trip is final: to push again, open the device again.
//   driver   calls the device. An exception of any kind, or silence from the guard, brings the device to zero. When it
//            blocks or dies, the guard ends it, and rescuer and guard take turns to open the device anew (rescue.h).
//   rescuer  the second watchdog. It opens the device in a fresh process and repeats zero until it is confirmed, when
//            the guard asks for it, when the guard dies, and when the guard's sign of life is older than `watchdog_s`
//            while a force is on. If the rescuer is gone or shows no sign of life, the guard lets go: nothing is pushed
//            without it.
//
// The last resort if the device itself does not obey: its own watchdog, and the physical switch, which the program asks
// for until zero is confirmed (wait_for_zero). A device has one guard: the lock is by what it says of itself.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "devices/interfaces.h"
#include "safety/guard_page.h"

namespace touchstone::hil {

// What the device may give to the hand unless the user says otherwise. The energy would bring a hand-held end of 0.2 kg
// (a stylus with what the hand adds to it) from rest to the usual speed limit of 1 m/s; a passive rendering gives back
// no more than was put in, and what a sampled wall of 1 kN/m makes of a 5 mm press at 0.2 m/s and 1 kHz is about 1 mJ
// (Colgate and Schenkel 1997). The power is that energy over the 20 ms that the guard needs to come to zero at worst.
inline constexpr double usual_energy_J = 0.5 * 0.2 * 1.0 * 1.0;
inline constexpr double usual_power_W = usual_energy_J / 0.02;
// Of the motors, if it is read: below what the insulation of small servo motors bears (class B, IEC 60085: 130 degrees)
// by the difference between winding and the place where a sensor sits.
inline constexpr double usual_temperature_C = 80.0;

struct GuardOptions {
  GuardOptions() {
    limits.stale_s = 0.01;
    limits.energy_J = usual_energy_J;
    limits.power_W = usual_power_W;
    limits.temperature_C = usual_temperature_C;
  }

  // limits.stale_s is the age of the last command and of the device's state at which the guard lets go; ramp_down_s is
  // not used: the guard goes to zero at once.
  SafetyLimits limits;
  double driver_timeout_s = 0.006;  // an exchange that takes longer while a force is on
  double idle_timeout_s = 0.1;      // an exchange at zero force, as while homing
  double watchdog_s = 0.008;        // silence of the guard while a force is on
  double open_timeout_s = 30.0;
  // Made beforehand by who wants to watch the guard from another process; none: made when the device is opened.
  std::shared_ptr<GuardPage> page;
};

class GuardedDevice : public HapticDevice {
 public:
  [[nodiscard]] virtual Trip tripped() const noexcept = 0;
  [[nodiscard]] virtual GuardPhase phase() const noexcept = 0;
  // Zero was confirmed since the last force; else a force may be on.
  [[nodiscard]] virtual bool at_zero() const noexcept = 0;
  // How long the device took to open. If its driver dies, zero comes that much later.
  [[nodiscard]] virtual double open_took_s() const noexcept = 0;
  // What the guard let pass of the last command.
  [[nodiscard]] virtual Vec3 last_allowed_N() const noexcept = 0;
  // States and their reasons since the device was opened.
  [[nodiscard]] virtual std::vector<GuardEvent> events() const = 0;
};

// That a force may be on, and what to do.
[[nodiscard]] std::string switch_text(const GuardedDevice& device);

// Waits until the device is at zero. From 50 ms on says switch_text() on stderr, once a second, until it is or until
// `stop` says that somebody has acted: then false.
bool wait_for_zero(const GuardedDevice& device, const std::function<bool()>& stop);

// Starts the guard; the device is opened by `open` in the driver's process, and again by the rescuer where it must. It
// is kept, for the case that this program is the last that lives: what it needs it holds by value. Call before any
// other thread is started (it forks). Throws UsageError for limits that are no finite numbers, DeviceError with the
// reason when the device cannot be opened, or if another guard has it (busy).
std::unique_ptr<GuardedDevice> open_guarded(const std::function<std::unique_ptr<HapticDevice>()>& open,
                                            const GuardOptions& options);

}  // namespace touchstone::hil
