#include "devices/device_error.h"

#include <array>

namespace touchstone::hil {

std::string_view to_string(DeviceStatus status) {
  constexpr std::array names{"present",   "absent", "no permission", "busy",      "wrong serial", "calibration expired",
                             "no driver", "failed", "gone",          "timed out", "not visible",  "not asked"};
  return names[static_cast<std::size_t>(status)];
}

std::string_view usual_advice(DeviceStatus status) {
  switch (status) {
    case DeviceStatus::absent:
      return "connect it and switch it on, or correct its entry in the hardware map";
    case DeviceStatus::no_permission:
      return "let your user open it: docs/how-to/lab.md, Permissions";
    case DeviceStatus::busy:
      return "end the program that has it";
    case DeviceStatus::wrong_serial:
      return "connect the one asked for, or correct \"serial\" in the hardware map";
    case DeviceStatus::calibration_expired:
      return "have it calibrated, then state the file, its hash and its day in the hardware map";
    case DeviceStatus::no_driver:
      return "install what is missing: docs/how-to/lab.md says what each device needs";
    case DeviceStatus::failed:
      return "switch it off and on and try again";
    case DeviceStatus::gone:
      return "check its cable and its power, then start again";
    case DeviceStatus::timed_out:
      return "check that it is switched on, that this is its address, and that no other program reads from it";
    case DeviceStatus::present:
    case DeviceStatus::invisible:
    case DeviceStatus::not_asked:
      break;
  }
  return {};
}

DeviceError::DeviceError(DeviceStatus device_status, const std::string& problem, const std::string& advice)
    : DeviceError(Whole(), device_status, [&] {
        const std::string_view step = advice.empty() ? usual_advice(device_status) : std::string_view(advice);
        return step.empty() ? problem : problem + "; " + std::string(step);
      }()) {}

DeviceError DeviceError::passed_on(DeviceStatus device_status, const std::string& message) {
  return {Whole(), device_status, message};
}

}  // namespace touchstone::hil
