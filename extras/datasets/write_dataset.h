// A data set of a recipe as a folder: dataset.json, mesh, instrument, recording, exact answer, provenance.
#pragma once

#include <cstdint>
#include <filesystem>

#include "recipe.h"

namespace touchstone::datasets {

// The recording is written as instruments do, in whole units of these: it is the same file from the same seed.
inline constexpr double position_unit_m = 1e-7;
inline constexpr double force_unit_N = 1e-5;
inline constexpr double orientation_unit = 1e-6;

// `recording` as it will read back from its file.
recording::Recording in_whole_units(recording::Recording recording);

// Writes into `folder`, made where it does not exist. Throws BadData when it cannot be written, UsageError when it
// holds files that are not the data set's own.
void write_dataset(const Recipe& recipe, std::uint64_t seed, const std::filesystem::path& folder);

}  // namespace touchstone::datasets
