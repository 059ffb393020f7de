#include "harness/testing/recorded_results.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace touchstone::testing {
namespace {

namespace fs = std::filesystem;

// Process numbers are used again; with its start a process is named once and for all (proc(5), field 22 of stat).
std::string parent_process() {
  const std::string parent = std::to_string(::getppid());
  std::ifstream file("/proc/" + parent + "/stat");
  std::string stat;
  std::getline(file, stat);
  // The second field is the program's name in brackets, which may hold spaces.
  std::istringstream fields(stat.substr(std::min(stat.rfind(')') + 1, stat.size())));
  std::string start;
  constexpr int fields_to_start = 20;  // from the third field on
  for (int i = 0; i < fields_to_start; ++i) fields >> start;
  return parent + "-" + start;
}

}  // namespace

fs::path results_of_this_run(const fs::path& results) { return results / parent_process(); }

fs::path result_file(const fs::path& results, std::string test) {
  std::ranges::replace(test, '/', '.');
  return results_of_this_run(results) / test;
}

std::optional<RecordedResult> recorded_result(const fs::path& results, const std::string& test) {
  std::ifstream file(result_file(results, test));
  RecordedResult result;
  if (!(file >> result.status) || file.get() != '\n') return std::nullopt;
  constexpr int skipped = 77;
  if (result.status != 0 && result.status != 1 && result.status != skipped) return std::nullopt;
  result.text.assign(std::istreambuf_iterator<char>(file), {});
  return result;
}

}  // namespace touchstone::testing
