// The three processes behind open_guarded() (guardian.h). Each function is the whole life of one and returns its exit
// status; none returns to the caller's code.
#pragma once

#include <functional>
#include <memory>

#include "harness/base/rooms.h"
#include "hil/safety/guardian.h"

namespace touchstone::hil {

using OpenDevice = std::function<std::unique_ptr<HapticDevice>()>;

// Forks driver and rescuer and serves the program at `client`.
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
