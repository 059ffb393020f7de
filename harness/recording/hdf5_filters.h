// Two of HDF5's filters, undone: the checksum over a chunk and the order of its bytes (HDF5 file format specification
// 3.0, IV.A.2.l). Whole vectors at a time: byte by byte they take as long as inflating does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace touchstone::recording {

// Fletcher's sum over big-endian 16-bit words, an odd byte at the end filled up by a zero, as HDF5 computes it.
std::uint32_t fletcher32(std::span<const unsigned char> bytes);

// Of `count` doubles the i-th byte of every one stands in the i-th of eight rows of `count` bytes: takes `to.size()`
// of them from the `first` on.
void unshuffle(const unsigned char* bytes, std::size_t count, std::size_t first, std::span<double> to);

}  // namespace touchstone::recording
