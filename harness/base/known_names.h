// "Unknown name" messages that help: the names that are known, and the one that was probably meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace touchstone {

// The known name closest to `name` by edit distance with transpositions (Damerau 1964,
// Levenshtein 1966), or "" when none is close.
std::string closest_name(std::string_view name, const std::vector<std::string>& known);

// One letter too many, too few or wrong, or two that changed places.
bool is_one_slip(std::string_view name, std::string_view meant);

// "there is no renderer \"god-objekt\"; did you mean god-object? Known: god-object, penalty"
std::string unknown_name(std::string_view what, std::string_view name, const std::vector<std::string>& known);

}  // namespace touchstone
