// From one file format or unit to another, in bounded memory: CSV, gzipped CSV and HDF5, by the extension.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "harness/recording/clock.h"
#include "harness/recording/column.h"

namespace touchstone::recording {

struct Conversion {
  std::uint64_t samples = 0;
  ClockReport clock;
  std::vector<std::string> notes;  // what was tolerated or changed
};

// Writes every column that `in` has, in `units`, to `out`; `out` appears whole at the end or, when anything is wrong
// with `in`, not at all. To SI units and back between formats nothing is lost; other units round once. `progress`,
// where given, is called with the number of samples done. Throws BadData, or UsageError for an unknown unit.
Conversion convert_recording(const std::filesystem::path& in, const std::filesystem::path& out,
                             const ColumnUnits& units = {}, const ClockPolicy& clock = {},
                             const std::function<void(std::uint64_t)>& progress = {});

}  // namespace touchstone::recording
