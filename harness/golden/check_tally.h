// What many checks of golden cases come to: counts, a line for each, and the results for other people's CI.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/golden/case_runner.h"
#include "harness/report/test_summary.h"

namespace touchstone::golden {

class CheckTally {
 public:
  // Counts a result, and returns what a person reads of it; `felt` is the tolerance if the verdict was `felt`.
  std::string add(const GoldenCase& golden, const std::string& model, const CheckResult& result, double seconds,
                  const FeltTolerance& felt);

  // Counts what could not be run; `folder` is the case's, or that of all cases.
  std::string add_unusable(const std::string& group, const std::string& model, const std::filesystem::path& folder,
                           const std::string& why);

  [[nodiscard]] bool unusable() const { return unusable_ > 0; }
  [[nodiscard]] bool failed() const { return failed_ > 0; }
  // Nothing ran that could pass.
  [[nodiscard]] bool all_skipped() const { return failed_ == 0 && passed_ == 0 && skipped_ > 0; }
  // "12 passed, 0 failed, 1 drifted\n"
  [[nodiscard]] std::string counts_text() const;
  // For JUnit, Markdown and annotations (report/test_summary.h).
  [[nodiscard]] const std::vector<report::CheckedTest>& tests() const { return tests_; }

 private:
  std::size_t passed_ = 0, failed_ = 0, drifted_ = 0, skipped_ = 0, unusable_ = 0;
  std::vector<report::CheckedTest> tests_;
};

}  // namespace touchstone::golden
