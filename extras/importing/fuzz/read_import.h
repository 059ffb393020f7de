// What the fuzzers of foreign files run, and a test runs over a seed corpus: reads the bytes as a file of one kind.
// Anything but BadData is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace touchstone::importing::fuzz {

// `extension`: ".txt", ".bag", ".db3", ".mat"; the bytes decide before it does. A table of text is also guessed.
void read_import(const std::uint8_t* data, std::size_t size, const std::string& extension);

// As an import map, and if it is one, applied to a small table.
void read_map(const std::uint8_t* data, std::size_t size);

}  // namespace touchstone::importing::fuzz
