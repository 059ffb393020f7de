#include "harness/baseline/acceptance.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>

namespace touchstone {
namespace {

namespace fs = std::filesystem;

// What git says about the tree; nothing when it cannot be asked.
std::optional<std::string> git_status(const fs::path& folder) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  std::array<std::string, 6> words{"git", "-C", folder.string(), "status", "--porcelain", "--untracked-files=normal"};
  std::array<char*, 7> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  pid_t child = 0;
  const bool started = posix_spawnp(&child, "git", &actions, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  std::string text;
  std::array<char, 4096> block{};
  for (ssize_t n = 0; started && (n = ::read(ends[0], block.data(), block.size())) > 0;)
    text.append(block.data(), static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = 1;
  if (started) ::waitpid(child, &status, 0);
  return status == 0 ? std::optional(text) : std::nullopt;
}

bool expected_result(const std::string& line) {
  const bool summary = line.ends_with("/expected.summary.json");
  return line.find("golden/") != std::string::npos && (summary || line.find("/expected/") != std::string::npos);
}

}  // namespace

std::vector<PendingResult> pending_results(const fs::path& out) {
  std::vector<PendingResult> pending;
  std::error_code error;
  for (const auto& folder : fs::directory_iterator(out, error)) {
    if (!folder.is_directory()) continue;
    for (const auto& model : fs::directory_iterator(folder.path(), error)) {
      if (fs::exists(model.path() / "obtained.h5")) {
        pending.push_back({folder.path().filename().string(), model.path().filename().string(), model.path()});
      }
    }
  }
  std::ranges::sort(pending, {}, [](const auto& p) { return std::pair(p.case_name, p.model); });
  return pending;
}

std::optional<std::string> acceptance_refused(const fs::path& golden) {
  const char* const ci = std::getenv("CI");
  if (ci != nullptr && *ci != '\0' && std::string_view(ci) != "false" && std::string_view(ci) != "0") {
    return "this runs under CI (the environment variable CI is set); goldens are accepted by a person";
  }
  const auto status = git_status(golden);
  if (!status)
    return fmt::format("{} is not in a git checkout, so that no commit could be named as the golden's origin",
                       golden.string());
  std::istringstream lines(*status);
  for (std::string line; std::getline(lines, line);) {
    if (!expected_result(line)) {
      return fmt::format(
          "the tree has changes that are not committed ({}); commit them first, so that the golden can say what made "
          "it",
          line.substr(std::min<std::size_t>(3, line.size())));
    }
  }
  return std::nullopt;
}

}  // namespace touchstone
