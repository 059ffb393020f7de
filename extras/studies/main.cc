// The program of the studies: touchstone-experiment, and by a link touchstone-blind. Its name is the command, which is
// how `touchstone experiment` and `touchstone blind` find it.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/program.h"
#include "commands.h"
#include "harness/base/bundled_files.h"

namespace {

// The program that started this one, else the one beside it: bundled recordings are found from there, and jobs and
// searches in a process of their own run it.
void find_touchstone() {
  const char* const started_by = std::getenv("TOUCHSTONE_PROGRAM");
  std::error_code error;
  const std::filesystem::path beside =
      std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "touchstone";
  touchstone::search_bundled_above(started_by != nullptr ? std::filesystem::path(started_by) : beside);
}

}  // namespace

int main(int argc, char** argv) {
  std::string called = std::filesystem::path(argc > 0 ? argv[0] : "").filename().string();
  std::vector<char*> words(argv, argv + argc);
  if (called.starts_with("touchstone-")) words.insert(words.begin() + 1, called.data() + called.find('-') + 1);
  words.push_back(nullptr);
  find_touchstone();
  return touchstone::apps::run_program(static_cast<int>(words.size()) - 1, words.data(),
                                       {touchstone::studies::add_blind, touchstone::studies::add_experiment});
}
