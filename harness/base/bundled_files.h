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

}  // namespace touchstone
