// Reads any file of columns (CSV, CSV in gzip, HDF5) for comparison: names and units are checked and converted to SI,
// values are taken as they stand, so that a NaN or a missing column is the comparison's finding.
#pragma once

#include <filesystem>
#include <utility>

#include "harness/golden/comparison/trajectory_columns.h"

namespace touchstone::golden {

// Throws BadData for a file that cannot be read and for a column whose name or unit is not known.
TrajectoryColumns load_columns(const std::filesystem::path& path);
// Both at once, on two threads.
std::pair<TrajectoryColumns, TrajectoryColumns> load_columns(const std::filesystem::path& expected,
                                                             const std::filesystem::path& obtained);

}  // namespace touchstone::golden
