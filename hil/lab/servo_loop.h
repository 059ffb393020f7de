// The servo loop of the lab's tests: the one way in which any of them commands a force, and not without a dead-man
// input. Every force passes the supervisor; the loop begins at zero until the device is calibrated and the dead-man is
// held, ends after a trip has ramped down, and leaves zero behind however it ends.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "safety/dead_man.h"
#include "safety/force_supervisor.h"

namespace touchstone::hil {

// What stands on the bench. Clock and device belong together: hardware with the monotonic clock, a simulated device
// with its own.
struct Bench {
  Clock& clock;
  HapticDevice& device;
  DeadMan* dead_man = nullptr;     // none: only runs at zero force
  WrenchSource* sensor = nullptr;  // started; read along with the servo loop where there is one
  SafetyLimits limits = {};
  double patience_s = 0.1;                                                   // for one exchange
  double hold_within_s = 30.0;                                               // how long the person has to take hold
  std::function<void(const std::string&)> tell = [](const std::string&) {};  // what the person is to do
  std::function<bool()> stop = [] { return false; };
};

struct ServoTick {
  double t_s = 0.0;  // since the run began, when the state was asked for
  Vec3 p_W_m = Vec3::Zero();
  Vec3 v_W_m_per_s = Vec3::Zero();
  Vec3 allowed_N = Vec3::Zero();  // what was commanded after the supervisor
};

struct ServoRun {
  double start_s = 0.0;                // on the bench's clock
  std::vector<ServoTick> ticks;        // at zero force before, while the person took hold, none are kept
  std::vector<WrenchSample> wrenches;  // t_s since the run began
  Trip trip = Trip::none;
  std::uint64_t saturated = 0;
  bool stopped = false;  // by the user

  // The whole of it was commanded as wanted.
  [[nodiscard]] bool whole() const noexcept { return trip == Trip::none && !stopped; }
};

// The force that is wanted in a state, `t_s` after the run began.
using WantedForce = std::function<Vec3(const DeviceState& state, double t_s)>;

// Throws UsageError without a dead-man input; DeviceError(timed_out) when nobody takes hold, or when the device fails.
ServoRun run_servo(Bench& bench, double seconds, const WantedForce& wanted, double rate_Hz = 1000.0);
// The same loop, which commands zero and nothing else.
ServoRun run_servo_at_zero(Bench& bench, double seconds, double rate_Hz = 1000.0);

}  // namespace touchstone::hil
