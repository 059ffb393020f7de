// A haptic device from a shared library with the C interface <touchstone/device.h>.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "devices/interfaces.h"

namespace touchstone::hil {

// Throws DeviceError: no_driver if the library cannot be loaded, has another version of the interface or lacks a
// function; failed with the library's own message if it does not open the device.
std::unique_ptr<HapticDevice> open_plugin_device(const std::filesystem::path& library, const std::string& settings);

}  // namespace touchstone::hil
