#include "harness/testing/conformance_results.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "harness/base/atomic_file.h"

namespace touchstone::testing {
namespace {

namespace fs = std::filesystem;

// Process numbers are used again; with its start a process is named once and for all (proc(5), field 22 of stat).
std::string parent_process() {
  const auto parent = ::getppid();
  std::ifstream file(fmt::format("/proc/{}/stat", parent));
  std::string stat;
  std::getline(file, stat);
  // The second field is the program's name in brackets, which may hold spaces.
  std::istringstream fields(stat.substr(std::min(stat.rfind(')') + 1, stat.size())));
  std::string start;
  constexpr int fields_to_start = 20;  // from the third field on
  for (int i = 0; i < fields_to_start; ++i) fields >> start;
  return fmt::format("{}-{}", parent, start);
}

fs::path file_of(const fs::path& results, std::string test) {
  std::ranges::replace(test, '/', '.');
  return results_of_this_run(results) / test;
}

std::string full_name(const ::testing::TestInfo& test) {
  return std::string(test.test_suite_name()) + "." + test.name();
}

}  // namespace

fs::path results_of_this_run(const fs::path& results) { return results / parent_process(); }

std::optional<RecordedResult> recorded_result(const fs::path& results, const std::string& test) {
  std::ifstream file(file_of(results, test));
  RecordedResult result;
  if (!(file >> result.status)) return std::nullopt;
  file.get();
  result.text.assign(std::istreambuf_iterator<char>(file), {});
  return result;
}

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
  write_file(file_of(folder_, full_name(test)), fmt::format("{}\n{}", status, text_));
}

}  // namespace touchstone::testing
