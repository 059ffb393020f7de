// Why a device cannot be used: one word for programs and skip rules, one sentence for people.
#pragma once

#include <string>
#include <string_view>

#include "harness/base/error.h"
#include "harness/base/rooms.h"

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
};
std::string_view to_string(DeviceStatus status);

// The message, with what the person at the device can do about the status. A message that says so itself, after a
// semicolon or as a question, stays as it is.
std::string with_next_step(DeviceStatus status, const std::string& message);

class DeviceError : public Error {
 public:
  DeviceError(DeviceStatus device_status, const std::string& message)
      : Error(ExitStatus::bad_data, with_next_step(device_status, message)), device_status_(device_status) {}
  [[nodiscard]] DeviceStatus device_status() const noexcept { return device_status_; }

 private:
  DeviceStatus device_status_;
};

}  // namespace touchstone::hil
