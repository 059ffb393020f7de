// What the fuzzers of the readers run, and a test runs over a seed corpus: reads the bytes as a file of one format, in
// every way that the program does. Anything but BadData is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace touchstone::recording::fuzz {

// `extension` chooses the reader: ".csv", ".csv.gz", ".h5". Returns how many samples were read (of the first 6,400).
std::size_t read_recording(const std::uint8_t* data, std::size_t size, const std::string& extension);

}  // namespace touchstone::recording::fuzz
