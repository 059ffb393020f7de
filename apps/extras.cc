#include "apps/extras.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <system_error>

#include "harness/base/error.h"
#include "harness/base/other_program.h"

namespace touchstone::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "touchstone-";
// Beside the program, and not for people.
constexpr std::array<std::string_view, 5> own_parts{"test-result", "emulated-lab", "evaluate", "full", "plugin-host"};

bool is_name(std::string_view name) {
  return !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string_view::npos &&
         std::ranges::find(own_parts, name) == own_parts.end();
}

fs::path own_folder() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

std::vector<fs::path> folders() {
  std::vector<fs::path> out{own_folder()};
  const char* const path = std::getenv("PATH");
  std::istringstream entries(path == nullptr ? "" : path);
  for (std::string folder; std::getline(entries, folder, ':');) out.emplace_back(folder.empty() ? "." : folder);
  return out;
}

// A program that does not know the name by which it was called would otherwise start itself again without end.
bool can_run(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0 &&
         !fs::equivalent(file, "/proc/self/exe", error);
}

void say_who_starts() { ::setenv("TOUCHSTONE_PROGRAM", (own_folder() / "touchstone").c_str(), 1); }

std::string cannot_run(const Extra& extra, std::string_view why) {
  return fmt::format("{}: {}; expected a program that this system runs", extra.program.string(), why);
}

}  // namespace

std::vector<Extra> find_extras(const std::vector<std::string>& commands) {
  std::map<std::string, fs::path> found;
  for (const fs::path& folder : folders()) {
    std::error_code error;  // folders on PATH may be missing or closed
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      const std::string file = entry->path().filename().string();
      if (!file.starts_with(prefix) || !is_name(std::string_view(file).substr(prefix.size()))) continue;
      if (can_run(entry->path())) found.try_emplace(file.substr(prefix.size()), entry->path());
    }
  }
  std::vector<Extra> out;
  for (const auto& [name, program] : found) {
    if (std::ranges::find(commands, name) == commands.end()) out.push_back({name, program});
  }
  return out;
}

std::optional<Extra> find_extra(std::string_view name) {
  if (!is_name(name)) return {};
  for (const fs::path& folder : folders()) {
    fs::path program = folder / fmt::format("{}{}", prefix, name);
    if (can_run(program)) return Extra{std::string(name), std::move(program)};
  }
  return {};
}

void become_extra(const Extra& extra, char** words) {
  std::vector<char*> arguments;
  std::string first = extra.program.string();
  arguments.push_back(first.data());
  for (; *words != nullptr; ++words) arguments.push_back(*words);
  arguments.push_back(nullptr);
  say_who_starts();
  std::signal(SIGXFSZ, SIG_DFL);  // what this program ignores the next one would
  ::execv(first.c_str(), arguments.data());
  throw UsageError(cannot_run(extra, std::strerror(errno)));
}

ExitStatus run_extra_and_wait(const Extra& extra, const std::vector<std::string>& words) {
  OtherProgram program{{extra.program.string()}};
  program.words.insert(program.words.end(), words.begin(), words.end());
  program.ends_with_this = true;
  say_who_starts();
  std::fflush(stdout);
  const auto end = run_other(program);
  if (!end) throw UsageError(cannot_run(extra, "it cannot be started"));
  return static_cast<ExitStatus>(end->status);
}

}  // namespace touchstone::apps
