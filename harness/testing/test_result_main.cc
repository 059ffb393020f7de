// touchstone-test-result: tells the outcome of one test of a GoogleTest program, if a run of many of its tests has
// recorded it in this ctest run; else becomes the program that runs the test. It starts in 1 ms, where a program with
// its libraries takes 10 to 30.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>

#include "harness/testing/recorded_results.h"

namespace {

constexpr const char* usage =
    "usage: touchstone-test-result RESULTS PROGRAM [ARGUMENT]... --gtest_filter=TEST\n"
    "  RESULTS  the folder into which a run of many tests has written (TOUCHSTONE_TEST_RESULTS, or --results of\n"
    "           touchstone-conformance)\n"
    "  TEST     as GoogleTest names it\n"
    "Exit status: the test's, as PROGRAM has it; 2 usage, or PROGRAM cannot be started.\n";

// As GoogleTest would say it: ctest looks for the mark of a skipped test.
int tell(const std::string& test, const touchstone::testing::RecordedResult& result) {
  const char* const mark = result.status == 0 ? "[       OK ]" : result.status == 1 ? "[  FAILED  ]" : "[  SKIPPED ]";
  std::printf("%s%s %s (from one run of many tests)\n", result.text.c_str(), mark, test.c_str());
  return result.status == 1 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs(usage, stderr);
    return 2;
  }
  constexpr std::string_view filter = "--gtest_filter=";
  for (int i = 3; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with(filter)) continue;
    const std::string test(word.substr(filter.size()));
    if (const auto known = touchstone::testing::recorded_result(argv[1], test)) return tell(test, *known);
  }
  ::execv(argv[2], argv + 2);
  std::fprintf(stderr, "touchstone-test-result: %s: %s; the program that runs the test was expected\n", argv[2],
               std::strerror(errno));
  return 2;
}
