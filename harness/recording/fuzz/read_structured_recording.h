// Recordings (CSV, HDF5) that are valid but for what the bytes change: types, ranks, lengths and layouts of datasets,
// attributes; separators, names, units and forms of numbers of tables. Findings as in read_recording.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace touchstone::recording::fuzz {

// Samples read; without bytes those of the two valid files (2 * 5).
std::size_t read_structured_recording(const std::uint8_t* data, std::size_t size);

}  // namespace touchstone::recording::fuzz
