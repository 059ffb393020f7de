// One run of many tests of a GoogleTest program serves each of them in one ctest run: it writes each test's outcome
// into a folder (result_recorder.h), and the program touchstone-test-result tells it in that test's place. Outcomes are
// those of the same ctest (the parent process, by its number and start), so that a test that is run alone, or again,
// does run. Without any library but the standard one: this is started once for every test.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace touchstone::testing {

struct RecordedResult {
  int status = 1;    // 0 passed, 1 failed, 77 skipped
  std::string text;  // what failed, or why it was skipped
};

// The folder of this ctest run below `results`.
std::filesystem::path results_of_this_run(const std::filesystem::path& results);
// Where the outcome of "Plugin/RendererConformance.NoForceInFreeSpace/mine_cube" is kept.
std::filesystem::path result_file(const std::filesystem::path& results, std::string test);
// That outcome; nothing if it was not recorded whole in this ctest run.
std::optional<RecordedResult> recorded_result(const std::filesystem::path& results, const std::string& test);

}  // namespace touchstone::testing
