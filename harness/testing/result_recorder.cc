#include "harness/testing/result_recorder.h"

#include <fmt/format.h>

#include "harness/base/atomic_file.h"
#include "harness/testing/recorded_results.h"

namespace touchstone::testing {

namespace fs = std::filesystem;

ResultRecorder::ResultRecorder(const fs::path& results) : folder_(results) {
  const fs::path own = results_of_this_run(results);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(results, ignored)) {
    const std::string name = entry.path().filename().string();
    // Only what looks as what is written here.
    const bool of_a_run = name.find_first_not_of("0123456789-") == std::string::npos && !entry.is_symlink(ignored);
    if (of_a_run && entry.path() != own) fs::remove_all(entry.path(), ignored);
  }
  ensure_writable_folder(own);
}

void ResultRecorder::OnTestStart(const ::testing::TestInfo&) { text_.clear(); }

void ResultRecorder::OnTestPartResult(const ::testing::TestPartResult& part) {
  if (part.passed()) return;
  if (part.file_name() != nullptr) text_ += fmt::format("{}:{}: ", part.file_name(), part.line_number());
  text_ += std::string(part.message()) + "\n";
}

void ResultRecorder::OnTestEnd(const ::testing::TestInfo& test) {
  constexpr int skipped = 77;
  const int status = test.result()->Failed() ? 1 : test.result()->Skipped() ? skipped : 0;
  write_file(result_file(folder_, std::string(test.test_suite_name()) + "." + test.name()),
             fmt::format("{}\n{}", status, text_));
}

}  // namespace touchstone::testing
