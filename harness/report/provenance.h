// Where a result came from: inputs by their SHA-256, the build, the command line. Part of every report.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/version.h"

namespace touchstone::report {

struct InputFile {
  std::string role;  // "recording", "mesh", "model"
  std::string name;  // the path as the user gave it
  std::string sha256;
  std::uint64_t bytes = 0;
};

struct Provenance {
  std::string command;      // the command line, quoted for a shell
  std::string created_utc;  // 2026-03-01T12:00:00Z
  BuildInfo build;
  std::vector<InputFile> inputs;
};

// Now, with this build.
Provenance make_provenance(const std::vector<std::string>& command_line);
// Hashes the file; throws BadData naming it when it cannot be read.
InputFile describe_input(std::string role, const std::filesystem::path& path);

}  // namespace touchstone::report
