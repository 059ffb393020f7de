// The devices of the hardware map, opened as what they are asked for.
#pragma once

#include <memory>

#include "devices/hardware_map.h"
#include "devices/interfaces.h"

namespace touchstone::hil {

inline constexpr double usual_card_rate_Hz = 5000.0;  // scans of a data acquisition card

// Each throws UsageError where the device is none of that kind or the map lacks what it needs (the message says what),
// DeviceError where it cannot be opened.
std::unique_ptr<WrenchSource> open_force(const MappedDevice& device, double card_rate_Hz = usual_card_rate_Hz);
std::unique_ptr<PoseSource> open_poses(const MappedDevice& device);
std::unique_ptr<HapticDevice> open_handle(const MappedDevice& device);

}  // namespace touchstone::hil
