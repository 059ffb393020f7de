// One run of the whole conformance suite serves every test of one ctest run: it writes each test's outcome into a
// folder, and a test that finds its own there tells it instead of running. Outcomes are those of the same ctest (the
// parent process, by its number and start), so that a test that is run alone, or again, does run.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include "harness/testing/testing_rooms.h"

namespace touchstone::testing {

struct RecordedResult {
  int status = 1;    // 0 passed, 1 failed, 77 skipped
  std::string text;  // what failed, or why it was skipped
};

// The folder of this ctest run below `results`.
std::filesystem::path results_of_this_run(const std::filesystem::path& results);
// The outcome of "Plugin/RendererConformance.NoForceInFreeSpace/mine_cube"; nothing where it was not recorded in this
// ctest run.
std::optional<RecordedResult> recorded_result(const std::filesystem::path& results, const std::string& test);

// Writes each test's outcome as it ends, so that those before a crash are there. Removes what earlier ctest runs left.
class ResultRecorder : public ::testing::EmptyTestEventListener {
 public:
  explicit ResultRecorder(const std::filesystem::path& results);
  void OnTestStart(const ::testing::TestInfo& test) override;
  void OnTestPartResult(const ::testing::TestPartResult& part) override;
  void OnTestEnd(const ::testing::TestInfo& test) override;

 private:
  std::filesystem::path folder_;
  std::string text_;
};

}  // namespace touchstone::testing
