// The devices of the hardware map, opened: which driver serves which id.
#pragma once

#include <memory>
#include <string>

#include "harness/base/rooms.h"
#include "hil/devices/hardware_map.h"
#include "hil/devices/interfaces.h"

namespace touchstone::hil {

// Throws UsageError if there is no driver that renders forces on it, DeviceError as the drivers do.
std::unique_ptr<HapticDevice> open_mapped_device(const std::string& id, const MappedDevice& mapped);

}  // namespace touchstone::hil
