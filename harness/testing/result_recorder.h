// Writes the outcome of each test of a GoogleTest program where recorded_results.h looks for it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace touchstone::testing {

// Writes each test's outcome as it ends, so that those before a crash are there. Removes what earlier ctest runs left.
class ResultRecorder : public ::testing::EmptyTestEventListener {
 public:
  // Throws BadData naming the folder if nothing can be written there.
  explicit ResultRecorder(const std::filesystem::path& results);
  void OnTestStart(const ::testing::TestInfo& test) override;
  void OnTestPartResult(const ::testing::TestPartResult& part) override;
  void OnTestEnd(const ::testing::TestInfo& test) override;

 private:
  std::filesystem::path folder_;
  std::string text_;
};

}  // namespace touchstone::testing
