#include "hil/devices/device_error.h"

#include <array>

namespace touchstone::hil {

std::string_view to_string(DeviceStatus status) {
  constexpr std::array names{"present",   "absent", "no permission", "busy",      "wrong serial", "calibration expired",
                             "no driver", "failed", "gone",          "timed out", "not visible"};
  return names[static_cast<std::size_t>(status)];
}

}  // namespace touchstone::hil
