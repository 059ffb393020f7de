// Recordings and golden cases that come with the program, found from where it stands: an installed program may be
// moved.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace touchstone {

// The folder share/touchstone/<installed> beside an installed program, or <in_tree> of the source tree above one that
// was built there; nothing when neither is there.
std::optional<std::filesystem::path> find_bundled(std::string_view installed, std::string_view in_tree);

}  // namespace touchstone
