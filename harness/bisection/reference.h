// What commits are measured by: the reference files of a golden case, and the build that makes the program of a commit.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

namespace touchstone::bisection {

// Touchstone's own build for sh, with the light commands alone; compilers' caches serve worktrees wherever they lie.
inline constexpr const char* own_build =
    "export CCACHE_BASEDIR=\"$SRC\" CCACHE_NOHASHDIR=1 "
    "CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime; "
    "cmake -S \"$SRC\" -B \"$BUILD\" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF "
    "-DTOUCHSTONE_BUILD_BENCHMARKS=OFF -DTOUCHSTONE_LIGHT=ON && cmake --build \"$BUILD\" --target touchstone_program";

struct GoldenReference {
  std::filesystem::path program;  // the touchstone that exports
  std::string golden_case;
  std::string golden_folder;  // empty: where the program finds its cases
};
// Writes the case's files to `to` by a child process, whose output is kept in `log`. Throws UsageError with that output
// if the case cannot be exported; ends early when `stopped` is set.
void export_reference(const GoldenReference& reference, const std::filesystem::path& to,
                      const std::filesystem::path& log, const std::atomic<bool>& stopped);

// The first model by name that has a golden, or the first by name if none has. Throws UsageError for a folder without
// a model.
std::string model_in(const std::filesystem::path& reference);

}  // namespace touchstone::bisection
