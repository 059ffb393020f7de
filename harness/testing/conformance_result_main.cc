// touchstone-conformance-result: tells the outcome of one test of the conformance suite, if a run of the whole suite
// has recorded it in this ctest run; else becomes the program that runs the test. It starts in 1 ms, where the suite
// with its libraries takes 3.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>

#include "harness/testing/conformance_results.h"

namespace {

constexpr const char* usage =
    "usage: touchstone-conformance-result RESULTS TEST PROGRAM [ARGUMENT]...\n"
    "  RESULTS  the folder of touchstone-conformance --results\n"
    "  TEST     as GoogleTest names it; the program is given --gtest_filter=TEST\n"
    "Exit status: the test's, as PROGRAM has it; 2 usage, or PROGRAM cannot be started.\n";

// As GoogleTest would say it: ctest looks for the mark of a skipped test.
int tell(const std::string& test, const touchstone::testing::RecordedResult& result) {
  const char* const mark = result.status == 0 ? "[       OK ]" : result.status == 1 ? "[  FAILED  ]" : "[  SKIPPED ]";
  std::printf("%s%s %s (from one run of the whole suite)\n", result.text.c_str(), mark, test.c_str());
  return result.status == 1 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fputs(usage, stderr);
    return 2;
  }
  const std::string test = argv[2];
  if (const auto known = touchstone::testing::recorded_result(argv[1], test)) return tell(test, *known);
  // The program's arguments, and the test: argv ends with a null pointer, and has two words too many in front.
  std::string filter = "--gtest_filter=" + test;
  char* const program = argv[3];
  for (int i = 3; i < argc; ++i) argv[i - 3] = argv[i];
  argv[argc - 3] = filter.data();
  argv[argc - 2] = nullptr;
  ::execv(program, argv);
  std::fprintf(stderr, "touchstone-conformance-result: %s: %s; the program that runs the test was expected\n", program,
               std::strerror(errno));
  return 2;
}
