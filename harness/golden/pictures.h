// Pictures of a golden and of what was obtained instead, in the same axes, and of their difference.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "harness/golden/comparison/trajectory_columns.h"

namespace touchstone::golden {

// CDash's names and the files: ValidImage (golden), TestImage (obtained), DifferenceImage2; what could not be drawn is
// said on stderr and left out.
std::vector<std::pair<std::string, std::filesystem::path>> draw_pictures(const TrajectoryColumns& expected,
                                                                         const TrajectoryColumns& obtained,
                                                                         const std::filesystem::path& folder);

}  // namespace touchstone::golden
