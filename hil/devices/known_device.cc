#include "devices/known_device.h"

namespace touchstone::hil {

std::string_view to_string(Bus bus) {
  constexpr std::array names{"usb", "network", "comedi", "serial", "invisible"};
  return names[static_cast<std::size_t>(bus)];
}

std::string_view to_string(Confidence confidence) {
  constexpr std::array names{"confirmed", "reported", "conflicting"};
  return names[static_cast<std::size_t>(confidence)];
}

}  // namespace touchstone::hil
