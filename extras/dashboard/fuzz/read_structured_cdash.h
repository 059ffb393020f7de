// Answers of a CDash server that are valid but for what the bytes change. Anything but BadData is a finding; so is a
// point that is no finite number.
#pragma once

#include <cstddef>
#include <cstdint>

namespace touchstone::dashboard::fuzz {

// How many points and rows were read; without bytes all that the valid answers hold (4).
std::size_t read_structured_cdash(const std::uint8_t* data, std::size_t size);

}  // namespace touchstone::dashboard::fuzz
