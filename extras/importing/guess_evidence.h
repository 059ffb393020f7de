// A proposed map against the numbers that it reads: what confirms it goes into its reasons, what contradicts it is to
// be decided.
#pragma once

#include <filesystem>

#include "guess_map.h"

namespace touchstone::importing {

// Fills `read` or `unreadable`; withdraws columns whose assumed unit cannot be right; writes `decide` and `reasons`
// into the map.
void hold_against_numbers(const std::filesystem::path& path, GuessedMap& guess);

}  // namespace touchstone::importing
