// SHA-256 of files and bytes, as lower-case hexadecimal: how reports and goldens name their inputs.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace touchstone {

std::string sha256(std::span<const std::byte> bytes);
std::string sha256(std::string_view text);
// Streams the file; throws BadData naming it when it cannot be read.
std::string sha256_file(const std::filesystem::path& path);

}  // namespace touchstone
