// Tests that run the built program as a user runs it, each in a folder of its own.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "harness/base/atomic_file.h"

namespace touchstone::testing {

struct Outcome {
  int status = -1;  // exit status; minus the signal where one ended it
  std::string out, err;
};

inline std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// A shell command; its output stays in `folder` as out.txt and err.txt.
// What another suite printed, for a test that shows it: ctest takes "[  SKIPPED ]" anywhere in what a failing test
// prints for a test that was skipped.
inline std::string of_another_suite(std::string text) {
  constexpr std::string_view mark = "[  SKIPPED ]", instead = "[ SKIPPED ]";
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += instead.size())
    text.replace(at, mark.size(), instead);
  return text;
}

inline Outcome run_command(const std::string& command, const std::filesystem::path& folder) {
  const int status = std::system(fmt::format("cd '{}' && {} > out.txt 2> err.txt", folder.string(), command).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), of_another_suite(read_file(folder / "out.txt")),
          of_another_suite(read_file(folder / "err.txt"))};
}

// Skips where the program of TOUCHSTONE_PROGRAM is not built.
class BuiltProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    program_ = environment("TOUCHSTONE_PROGRAM");
    if (program_.empty() || !std::filesystem::exists(program_))
      GTEST_SKIP() << "needs the built program in TOUCHSTONE_PROGRAM";
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = fmt::format("touchstone-{}-{}", test->test_suite_name(), test->name());
    std::replace(name.begin(), name.end(), '/', '-');
    folder_ = std::filesystem::path(::testing::TempDir()) / name;
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  // What a failed test leaves can be looked at.
  void TearDown() override {
    if (!folder_.empty() && !HasFailure()) std::filesystem::remove_all(folder_);
  }

  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return run_command(fmt::format("'{}' {}", program_, arguments), folder_);
  }

  std::string program_;
  std::filesystem::path folder_;  // the program's working folder
};

}  // namespace touchstone::testing
