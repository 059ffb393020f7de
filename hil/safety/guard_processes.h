// The three processes behind open_guarded() (guardian.h). Each function is the whole life of one and returns its exit
// status; none returns to the caller's code.
//   Driver and rescuer are children of the guard. It and the rescuer let the kernel forget their children as soon as
//   they
// end (SIGCHLD ignored): so no driver that ended is left as a zombie while the guard lives, be it stopped, and a device
// that is locked by its owner's number (/var/lock/LCK..*) can be opened anew at once. If the guard is dead, the
// system's first process inherits the driver and has to reap it.
#pragma once

#include <functional>
#include <memory>

#include "safety/guardian.h"

namespace touchstone::hil {

using OpenDevice = std::function<std::unique_ptr<HapticDevice>()>;

// Starts driver and rescuer and serves the program at `client`.
int run_guard(int client, const OpenDevice& open, const GuardOptions& options, GuardPage& page);
// Opens the device and serves the guard at `guard`.
int run_driver(int guard, const OpenDevice& open, const GuardOptions& options, GuardPage& page);
// Watches the guard, whose end of the pipe `guard` closes with it.
int run_rescuer(int guard, const OpenDevice& open, const GuardOptions& options, GuardPage& page);

// What the guard writes to the rescuer.
inline constexpr char rescuer_rescue = 'r', rescuer_end = 'e';

// Commands zero until the device confirms it, at most until the deadline, then switches the motors off.
bool bring_to_rest(HapticDevice& device, double deadline_s) noexcept;

}  // namespace touchstone::hil
