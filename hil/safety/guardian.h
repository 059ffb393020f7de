// The outer guard: the device is owned by a process of its own, the guardian, and the program that computes forces
// talks to it over a socket. When that program goes away in any way (return, exception, exit, signal, SIGKILL) the
// socket closes and the guardian brings the device to zero at once; when it hangs, the guardian does so after
// `heartbeat_s`. Should the guardian itself die, the device's own watchdog remains, and where there is none (Novint
// Falcon) the physical switch.
#pragma once

#include <functional>
#include <memory>

#include "hil/devices/interfaces.h"

namespace touchstone::hil {

struct GuardianOptions {
  double heartbeat_s = 0.02;        // silence after which the guardian lets go
  double exchange_timeout_s = 0.1;  // a device exchange that takes longer is a failure
};

// Starts the guardian; it opens the device by `open` in its own process. Call before any other thread is started (it
// forks). Throws DeviceError with the guardian's reason when the device cannot be opened. The returned device sends
// every exchange through the guardian.
std::unique_ptr<HapticDevice> open_guarded(const std::function<std::unique_ptr<HapticDevice>()>& open,
                                           const GuardianOptions& options);

}  // namespace touchstone::hil
