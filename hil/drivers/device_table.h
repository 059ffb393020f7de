// The devices that a haptics laboratory may have: the one list. A device with a driver describes itself beside it
// (hil/devices/known_device.h), one without has its entry in device_table.cc.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "devices/known_device.h"

namespace touchstone::hil {

std::span<const KnownDevice* const> known_devices();
const KnownDevice* find_known_device(std::string_view id);
// The device that these USB ids and product string may be.
const KnownDevice* match_usb(std::uint16_t vendor, std::uint16_t product, std::string_view product_string);

// What a person does with this handle while it is not calibrated (homed), as ": do this"; empty where nothing is known.
std::string calibrating_text(std::string_view id);

// The ids of those for which it holds, as "a, b, c".
std::string ids_of_devices(bool (*holds)(const KnownDevice&));

}  // namespace touchstone::hil
