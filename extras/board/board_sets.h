// The data sets of a leaderboard without --dataset: the bundled ones, and the synthetic families with exact answers.
#pragma once

#include <filesystem>
#include <vector>

namespace touchstone::board {

// Writes the synthetic ones that are not there yet into `folder`, each in a folder of its name, always of seed 1.
std::vector<std::filesystem::path> board_sets(const std::filesystem::path& folder);

}  // namespace touchstone::board
