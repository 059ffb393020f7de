// The program `touchstone`: runs the light commands itself, and becomes another file for the others: an extra,
// touchstone-evaluate for `evaluate`, touchstone-full for the rest; these two stand beside it.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "apps/commands.h"
#include "apps/extras.h"
#include "apps/program.h"

namespace {

bool is_among(const auto& names, std::string_view command) { return std::ranges::find(names, command) != names.end(); }

// Its own commands, and extras, which run_program() becomes.
bool starts_here(std::string_view command) {
  namespace apps = touchstone::apps;
  return is_among(apps::light_command_names, command) ||
         (!is_among(apps::heavy_command_names, command) && apps::find_extra(command).has_value());
}

// Return only when that fails.
int become(const std::filesystem::path& program, char** argv) {
  ::execv(program.c_str(), argv);
  return errno;
}

int become_another(char** argv, std::string_view command) {
  std::error_code error;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  if (command == "evaluate") become(folder / "touchstone-evaluate", argv);
  const auto full = folder / "touchstone-full";
  const int why = become(full, argv);
  fmt::print(stderr,
             "touchstone: {}: {}; all commands but check, compare, evaluate, golden, replay, scorecard and version "
             "are in that file, which belongs beside this one (in a checkout: ci/build default --target "
             "touchstone_program)\n",
             full.string(), std::strerror(why));
  return static_cast<int>(touchstone::ExitStatus::usage);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view command = argc < 2 ? "" : argv[1];
  if (!starts_here(command)) return become_another(argv, command);
  return touchstone::apps::run_program(argc, argv, touchstone::apps::light_commands());
}
