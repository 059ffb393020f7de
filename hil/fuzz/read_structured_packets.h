// Packets of devices that are valid but for what the bytes change. Anything but DeviceError and BadData is a finding;
// so is a pose or a wrench with a number that is none.
#pragma once

#include <cstddef>
#include <cstdint>

namespace touchstone::hil::fuzz {

// How many of the readers read something; without bytes all 7.
std::size_t read_structured_packets(const std::uint8_t* data, std::size_t size);

}  // namespace touchstone::hil::fuzz
