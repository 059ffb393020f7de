// Model and scene files that are valid but for what the bytes change. Anything but BadData is a finding; so is a model
// whose own text does not give it back.
#pragma once

#include <cstddef>
#include <cstdint>

namespace touchstone::rendering::fuzz {

// What became of it; without bytes both are read.
struct Read {
  bool model = false, scene = false;
};
Read read_structured_model(const std::uint8_t* data, std::size_t size);

}  // namespace touchstone::rendering::fuzz
