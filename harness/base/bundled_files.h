// Recordings and golden cases that come with the program, found from where it stands: an installed program may be
// moved.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace touchstone {

// The folder share/touchstone/<name> in a folder above the running program: beside bin/ of an installed program as of
// one that was just built (its build folder links there to the source tree). Nothing if there is none.
std::optional<std::filesystem::path> find_bundled(std::string_view name);

// The file of this program, to be run again in a process of its own. Inside a program that is not Touchstone's:
// bin/touchstone-full in a folder above; empty if there is none.
std::filesystem::path own_program();

// From here on the folders above `file` are searched instead: for a library inside a program that is not Touchstone's.
void search_bundled_above(const std::filesystem::path& file);

}  // namespace touchstone
