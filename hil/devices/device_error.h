// Why a device cannot be used: one word for programs and skip rules, one sentence for people.
#pragma once

#include <string>
#include <string_view>

#include "harness/base/error.h"

namespace touchstone::hil {

enum class DeviceStatus {
  present,
  absent,               // not there
  no_permission,        // there, but this user may not open it (udev rules)
  busy,                 // another program has it
  wrong_serial,         // one of its kind is there, but not the one in the hardware map
  calibration_expired,  // or changed, or missing: the device must not be used until that is put right
  no_driver,            // a library or a kernel driver that it needs is missing
  failed,               // it answered with an error
  gone,                 // it was there and went away
  timed_out,            // it did not answer before the deadline
  invisible,            // it cannot be seen by this program at all
  not_asked,            // the hardware map has it; nobody connected to it, since it was not named
};
std::string_view to_string(DeviceStatus status);

// What the person at the device can usually do about it; empty: nothing.
std::string_view usual_advice(DeviceStatus status);

// Says what is wrong, then what to do about it: advice of its own, or what is usual for its status.
class DeviceError : public Error {
 public:
  DeviceError(DeviceStatus device_status, const std::string& problem, const std::string& advice = "");
  // A whole message, advice and all, that another process said of its device.
  static DeviceError passed_on(DeviceStatus device_status, const std::string& message);

  [[nodiscard]] DeviceStatus device_status() const noexcept { return device_status_; }

 private:
  struct Whole {};
  DeviceError(Whole, DeviceStatus device_status, const std::string& message)
      : Error(ExitStatus::bad_data, message), device_status_(device_status) {}

  DeviceStatus device_status_;
};

}  // namespace touchstone::hil
