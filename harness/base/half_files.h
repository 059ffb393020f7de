// What a run that fails or is interrupted must not leave behind: files that are being written beside their place
// (atomic_file.h), and folders that it made and put nothing into.
#pragma once

#include <filesystem>
#include <system_error>

namespace touchstone {

// An interrupt removes the file, from the first to the second. For whoever makes and removes or renames it.
void add_half_file(const std::filesystem::path& path) noexcept;
void drop_half_file(const std::filesystem::path& path) noexcept;

// Makes the folder and those above it that are missing, and remembers which it made.
[[nodiscard]] std::error_code make_folders(const std::filesystem::path& folder);
// After a run: those that make_folders() made since the last call are removed where they hold nothing, or nothing but
// what hides them from git (atomic_file.h); with `keep` they are only forgotten.
void remove_empty_made_folders(bool keep = false) noexcept;

// From here on SIGINT, SIGTERM and SIGHUP remove the half files and the empty folders, then end the program as they
// always do. For programs, once, at their start.
void remove_half_files_when_interrupted();

}  // namespace touchstone
