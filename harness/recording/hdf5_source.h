// HDF5: one dataset per column in the root group, named as a CSV column ("x_m"), one value per sample. A dataset's
// attribute `unit`, where present, must agree with its name; the file's attribute `schema`, where present, must be
// touchstone-recording/1. Raw data may be chunked and compressed; checksums are verified as they are read.
#pragma once

#include <filesystem>
#include <memory>

#include "harness/recording/table_source.h"

namespace touchstone::recording {

inline constexpr const char* recording_schema = "touchstone-recording/1";

// A file is first tried in a child process, since the library may crash on a damaged one. Throws BadData, and prints
// nothing, for a file that is truncated, damaged, not HDF5 or HDF5 of another layout.
std::unique_ptr<TableSource> open_hdf5_source(const std::filesystem::path& path);

}  // namespace touchstone::recording
