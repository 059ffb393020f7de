// Whether a lab test may run on a device here, must be skipped with a reason, or must fail because the device was
// promised.
//   TOUCHSTONE_REQUIRE_HIL=1, or "connected": true in the hardware map: absence is a failure.
//   TOUCHSTONE_HIL_EMULATED=1: the tests run against emulators, and every result says so.
#pragma once

#include <string>

#include "devices/probe.h"

namespace touchstone::hil {

enum class Decision { run, skip, fail };

struct Availability {
  Decision decision = Decision::skip;
  bool emulated = false;
  std::string reason;  // for people, names the device
};

// From a probe's result and the rules; `require_all` is TOUCHSTONE_REQUIRE_HIL.
Availability judge(const ProbeResult& result, bool require_all);
// A test that commands forces on hardware needs a dead-man input: without `specification` it is skipped, or fails where
// absence is a failure.
Availability judge_dead_man(const Availability& device, const std::string& specification, bool must_run);
// Probes the device and applies the environment.
Availability availability(const std::string& device_id);

}  // namespace touchstone::hil
