// Meshes of the four formats that are valid but for what the bytes change: declared counts, indices, element layouts,
// types of properties, numbers. Findings as in read_mesh.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace touchstone::surface::fuzz {

// How many files were read; without bytes the valid ones of all formats (6).
std::size_t read_structured_mesh(const std::uint8_t* data, std::size_t size);

}  // namespace touchstone::surface::fuzz
