// Tools given by points, as files: a table (CSV, HDF5) with a row for each point of the shell, in the tool's frame
// (origin: the handle): x_m, y_m, z_m (or another unit of length) and the outward normal nx, ny, nz, of any length.
#pragma once

#include <filesystem>

#include "harness/tool/tool.h"

namespace touchstone::tool {

// Throws BadData that names file, line and column for a column that is missing or not known, a value that is not
// finite, or a normal without direction.
PointShell load_point_shell(const std::filesystem::path& path);
void save_point_shell(const PointShell& shell, const std::filesystem::path& path);

}  // namespace touchstone::tool
