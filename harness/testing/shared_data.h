// Recordings that this project did not make and does not ship: found through the environment variable
// TOUCHSTONE_DATA_DIR. A test that needs one skips, saying why, where it is absent.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace touchstone::testing {

inline std::optional<std::filesystem::path> shared_data(const std::string& relative) {
  const char* const folder = std::getenv("TOUCHSTONE_DATA_DIR");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  std::filesystem::path path = std::filesystem::path(folder) / relative;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

}  // namespace touchstone::testing

// Declares `const std::filesystem::path& name`, or skips the test (GoogleTest) with the reason.
#define TOUCHSTONE_SHARED_DATA_OR_SKIP(name, relative)                                              \
  const auto name##_found = ::touchstone::testing::shared_data(relative);                           \
  if (!name##_found)                                                                                \
    GTEST_SKIP() << "needs " << (relative) << " under TOUCHSTONE_DATA_DIR, which is "               \
                 << (std::getenv("TOUCHSTONE_DATA_DIR") ? "set, but has no such file" : "not set"); \
  const std::filesystem::path& name = *name##_found  // NOLINT(bugprone-macro-parentheses): a name cannot stand in them
