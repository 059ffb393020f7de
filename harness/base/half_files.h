// Files that are being written beside their place (atomic_file.h) must not stay behind when the program is interrupted.
#pragma once

#include <filesystem>

namespace touchstone {

// An interrupt removes the file, from the first to the second. For whoever makes and removes or renames it.
void add_half_file(const std::filesystem::path& path) noexcept;
void drop_half_file(const std::filesystem::path& path) noexcept;

// From here on SIGINT, SIGTERM and SIGHUP remove the half files, then end the program as they always do. For programs,
// once, at their start.
void remove_half_files_when_interrupted();

}  // namespace touchstone
