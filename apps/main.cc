// The program `touchstone`: runs the light commands itself, and becomes touchstone-full, which stands beside it, for
// all others.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "apps/commands.h"
#include "apps/program.h"

namespace {

bool is_light(std::string_view command) {
  return std::ranges::find(touchstone::apps::light_command_names, command) !=
         touchstone::apps::light_command_names.end();
}

// Returns only when that fails.
int become_full(char** argv) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto full = self.parent_path() / "touchstone-full";
  ::execv(full.c_str(), argv);
  fmt::print(stderr,
             "touchstone: {}: {}; all commands but check, compare, golden, replay, scorecard and version are in that "
             "file, which "
             "belongs beside this one\n",
             full.string(), std::strerror(errno));
  return static_cast<int>(touchstone::ExitStatus::usage);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || !is_light(argv[1])) return become_full(argv);
  return touchstone::apps::run_program(argc, argv, touchstone::apps::light_commands());
}
