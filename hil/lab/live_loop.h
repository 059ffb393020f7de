// A servo loop that a renderer runs live: at each tick the device's state goes in, the wanted force comes out, passes
// the guard (guardian.h), and everything is kept, so that the run can be compared with a replay of its own path.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "safety/dead_man.h"
#include "safety/guardian.h"

namespace touchstone::hil {

struct LiveTick {
  double t_s = 0.0;  // of the state, since the run began
  DeviceState state;
  Vec3 wanted_W_N = Vec3::Zero();   // what the renderer answered to this state
  Vec3 allowed_W_N = Vec3::Zero();  // what the guard let pass of it
  double late_s = 0.0;              // of the tick against its time
  double step_us = 0.0;             // of the renderer alone
};

struct LiveRun {
  std::vector<LiveTick> ticks;  // from the first tick on at which the device was calibrated and the dead-man held
  double rate_Hz = 0.0;         // that was reached
  std::uint64_t missed = 0;     // deadlines: ticks that began a whole period late or later
  std::uint64_t cut = 0;        // ticks at which the guard let less pass than was wanted
  std::uint64_t stale = 0;      // ticks without a new state: not rendered, the last force was commanded again
  std::string ended;            // "time is up", "stopped by the user", "dead-man released", or what went wrong
  bool whole = false;           // it ran to its end
};

struct LiveOptions {
  double seconds = 10.0;
  double rate_Hz = 1000.0;
  double ready_within_s = 30.0;                                              // calibrated and held
  double exchange_s = 0.1;                                                   // patience with one exchange
  std::function<void(const std::string&)> tell = [](const std::string&) {};  // what the person is to do
};

// `step` must allocate nothing and wait for nothing. `dead_man` may be null if nobody is at the device (emulated). The
// force of a tick answers the state of the exchange before it, one period old. Leaves zero behind however it ends;
// never throws for what the device or the guard does: that is in `ended`.
LiveRun run_live(GuardedDevice& device, const LiveOptions& options, DeadMan* dead_man,
                 const std::function<bool()>& stop,
                 const std::function<Vec3(const DeviceState& state, double t_s)>& step);

}  // namespace touchstone::hil
