// The entries of a zip archive (through libarchive), unpacked by pieces within a bound.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace touchstone::importing {

// Calls `use` with the name and the bytes of each entry that `wanted` holds of, in the order of the archive. Throws
// BadData where the archive is damaged or cut short, or all of them are more than `most_bytes`.
void for_each_zip_entry(const std::filesystem::path& path, std::uintmax_t most_bytes,
                        const std::function<bool(const std::string&)>& wanted,
                        const std::function<void(const std::string&, std::string)>& use);

}  // namespace touchstone::importing
